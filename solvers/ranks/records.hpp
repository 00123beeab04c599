#pragma once

#include <vector>

// Also compiled as C++17.

namespace peristat {

/// Records of some doubles and some integers, which are sent between ranks.
struct Records {
  int doubles = 0, integers = 0;  ///< per record
  std::vector<double> values{};
  std::vector<long long> numbers{};
};

}  // namespace peristat
