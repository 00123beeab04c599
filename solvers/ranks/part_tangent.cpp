#include "solvers/ranks/part_tangent.hpp"

#include <cstddef>
#include <utility>

namespace peristat {

std::vector<char> without_ghosts(const Sharing& sharing, std::vector<char> prescribed,
                                 int dimension) {
  const std::size_t owned = std::size_t(sharing.owned()) * std::size_t(dimension);
  std::fill(prescribed.begin() + std::ptrdiff_t(owned), prescribed.end(), char(1));
  return prescribed;
}

}  // namespace peristat
