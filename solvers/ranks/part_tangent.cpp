#include "solvers/ranks/part_tangent.hpp"

#include <cstddef>
#include <utility>

#include "src/parallel/index_map.hpp"

namespace peristat {

std::vector<char> without_ghosts(const IndexMap& index_map, std::vector<char> prescribed,
                                 int dimension) {
  const auto d = std::ptrdiff_t(dimension);
  const auto handles = std::min(prescribed.begin() + index_map.count() * d, prescribed.end());
  std::fill(prescribed.begin() + index_map.owned() * d,
            index_map.is_first_rank() ? handles : prescribed.end(), char(1));
  return prescribed;
}

}  // namespace peristat
