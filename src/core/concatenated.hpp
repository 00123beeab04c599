#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "src/core/communicator.hpp"

namespace peristat {

/// Concatenates the numbers of all ranks, of any count each, in their order; all ranks get the
/// result. Collective.
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
