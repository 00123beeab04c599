#include "solvers/ranks/part_of_body.hpp"

#include <algorithm>
#include <cstddef>

namespace peristat {
namespace {

/// Number of images of owned points; they are the first images.
Index count_images_of_owned(const Points& points) {
  Index count = 0;
  for (Index image = points.own(); image < points.count(); ++image) count += points.owns(image);
  return count;
}

}  // namespace

PartOfBody::PartOfBody(const Part& part, const Communicator& ranks)
    : ranks_(ranks),
      number_(part.number.begin(), part.number.begin() + std::ptrdiff_t(part.owned)),
      ghost_number_(part.number.begin() + std::ptrdiff_t(part.owned), part.number.end()),
      ghost_owner_(part.owner),
      count_(part.points.count()),
      owned_images_(count_images_of_owned(part.points)),
      dimension_(std::size_t(part.points.dimension)),
      whole_(part.whole),
      ghosts_(make_ghost_exchange(ranks, number_, ghost_number_, part.points.dimension)) {}

void PartOfBody::update_ghosts(std::span<double> values) const {
  ghosts_->update(values.data());
  const auto dofs = std::size_t(count_) * dimension_;
  if (values.size() <= dofs) return;
  const std::span<double> handles = values.subspan(dofs);
  if (ranks_.rank() > 0) std::ranges::fill(handles, 0.0);
  add_up(ranks_, handles);
}

}  // namespace peristat
