#include "src/parallel/numbered_points.hpp"

#include <algorithm>

namespace peristat {

std::optional<Index> NumberedPoints::find(GlobalIndex number) const {
  Index before = 0;
  for (const std::span<const GlobalIndex> numbers : {owned, ghosts}) {
    const auto found = std::lower_bound(numbers.begin(), numbers.end(), number);
    if (found != numbers.end() && *found == number) {
      return before + Index(found - numbers.begin());
    }
    before += Index(numbers.size());
  }
  return std::nullopt;
}

}  // namespace peristat
