#include "solvers/ranks/part_tangent.hpp"

#include <cstddef>
#include <utility>

namespace peristat {

std::vector<char> without_ghosts(const Sharing& sharing, std::vector<char> prescribed,
                                 int dimension) {
  const auto d = std::ptrdiff_t(dimension);
  const auto handles = std::min(prescribed.begin() + sharing.count() * d, prescribed.end());
  const bool owns_handles = sharing.ranks().rank() == 0;
  std::fill(prescribed.begin() + sharing.owned() * d, owns_handles ? handles : prescribed.end(),
            char(1));
  return prescribed;
}

}  // namespace peristat
