#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "src/core/communicator.hpp"

namespace peristat {

/// What the ranks give, as many numbers as each likes, one after the other; all get all of it. A
/// call that all ranks make.
[[nodiscard]] inline std::vector<double> concatenated(const std::vector<double>& mine,
                                                      const Communicator& ranks) {
  if (ranks.count() == 1) return mine;
  std::string all;
  ranks.gather(
      std::string(reinterpret_cast<const char*>(mine.data()), mine.size() * sizeof(double)),
      [&](int, const std::string& bytes) { all += bytes; });
  ranks.broadcast(all);
  std::vector<double> numbers(all.size() / sizeof(double));
  if (!all.empty()) std::memcpy(numbers.data(), all.data(), all.size());
  return numbers;
}

}  // namespace peristat
