#pragma once

#include <vector>

// Read as C++17, too.

namespace peristat {

/// Records of some doubles and some whole numbers, which go from rank to rank.
struct Records {
  int doubles = 0, integers = 0;  ///< of each record
  std::vector<double> values{};
  std::vector<long long> numbers{};
};

}  // namespace peristat
