#pragma once

#include "src/core/types.hpp"

namespace peristat {

/// The next number of places, n itself or a few more, for which transforms are fast: without prime
/// factors above 13. They take a fifth to a third of the time for one with a large prime factor.
[[nodiscard]] inline Index good_size(Index n) {
  const auto is_good = [](Index size) {
    for (const Index prime : {2, 3, 5, 7, 11, 13}) {
      while (size % prime == 0) size /= prime;
    }
    return size == 1;
  };
  while (!is_good(n)) ++n;
  return n;
}

}  // namespace peristat
