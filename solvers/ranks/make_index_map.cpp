#include "solvers/ranks/make_index_map.hpp"

#include <cstddef>
#include <utility>

#include "solvers/ranks/ranks.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Number of images of owned points; they are the first images.
Index count_images_of_owned(const Points& points) {
  Index count = 0;
  for (Index image = points.own(); image < points.count(); ++image) count += points.owns(image);
  return count;
}

}  // namespace

IndexMap make_index_map(const Part& part, const Communicator& ranks) {
  const auto first_ghost = part.number.begin() + std::ptrdiff_t(part.owned);
  IndexMap::Numbers numbers;
  numbers.owned.assign(part.number.begin(), first_ghost);
  numbers.ghosts.assign(first_ghost, part.number.end());
  numbers.owner = part.owner;
  numbers.images = part.points.count() - part.points.own();
  numbers.owned_images = count_images_of_owned(part.points);
  numbers.whole = part.whole;
  const int dimension = part.points.dimension;
  auto exchange = make_ghost_exchange(ranks, numbers.owned, numbers.ghosts, dimension);
  return {ranks, std::move(numbers), dimension, std::move(exchange)};
}

}  // namespace peristat
