#include "src/parallel/index_map.hpp"

#include <utility>

#include "src/parallel/collectives.hpp"

namespace peristat {

IndexMap::IndexMap(Index own, Index images) : ranks_(sole_rank()), owned_(own), first_image_(own) {
  numbers_.images = numbers_.owned_images = images;
  numbers_.whole = own;
}

IndexMap::IndexMap(const Communicator& ranks, Numbers numbers, int dimension,
                   std::unique_ptr<GhostExchange> exchange)
    : ranks_(ranks),
      numbers_(std::move(numbers)),
      owned_(Index(numbers_.owned.size())),
      first_image_(owned_ + Index(numbers_.ghosts.size())),
      dimension_(std::size_t(dimension)),
      exchange_(std::move(exchange)) {}

std::optional<Index> IndexMap::find(GlobalIndex number) const {
  if (!is_whole()) return numbered().find(number);
  return number < numbers_.whole ? std::optional(Index(number)) : std::nullopt;
}

void IndexMap::update_ghosts(std::span<double> values) const {
  if (is_whole()) return;
  exchange_->update(values.data());
  const auto dofs = std::size_t(count()) * dimension_;
  if (values.size() <= dofs) return;
  const std::span<double> of_constraints = values.subspan(dofs);
  if (!is_first_rank()) std::ranges::fill(of_constraints, 0.0);
  add_up(ranks_, of_constraints);
}

void IndexMap::update_ghost_values(std::span<double> values) const {
  if (is_whole()) return;
  std::vector<double> vectors(values.size() * dimension_);
  for (std::size_t i = 0; i < values.size(); ++i) vectors[i * dimension_] = values[i];
  exchange_->update(vectors.data());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = vectors[i * dimension_];
}

std::vector<double> IndexMap::numbers(std::size_t points) const {
  std::vector<double> numbers(points, 0.0);
  const std::size_t numbered = std::min(points, std::size_t(first_image_));
  for (std::size_t i = 0; i < numbered; ++i) numbers[i] = double(number_of(Index(i)));
  return numbers;
}

const IndexMap& whole_body() {
  static const IndexMap map(std::numeric_limits<Index>::max(), 0);
  return map;
}

}  // namespace peristat
