#pragma once

#include <algorithm>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "src/core/vector_verbs.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Replaces values of which each rank has a summand by their sums over all ranks. Collective.
inline void add_up(const Communicator& ranks, std::span<double> shares) {
  if (ranks.count() == 1 || shares.empty()) return;
  const std::vector<double> all = ranks.sum(std::vector<double>(shares.begin(), shares.end()));
  std::copy(all.begin(), all.end(), shares.begin());
}

/// True if the flag is set on any rank. Collective.
[[nodiscard]] inline bool any_of_all(const Communicator& ranks, bool is_here) {
  return ranks.max(is_here ? 1.0 : 0.0) > 0.0;
}

/// 2-norm of a vector from the norms of its parts. Collective.
[[nodiscard]] inline double norm_of_all(const Communicator& ranks, double norm_of_part) {
  const std::vector<double> norms = ranks.all_of({norm_of_part});
  return norms.size() == 1 ? norms.front() : norm(norms);
}

/// Concatenates the numbers of all ranks, of any count each, at rank 0. Collective.
/// @return the bytes at rank 0, elsewhere nothing
[[nodiscard]] inline std::string gathered(const Communicator& ranks,
                                          const std::vector<double>& mine) {
  std::string all, bytes(mine.size() * sizeof(double), '\0');
  if (!mine.empty()) std::memcpy(bytes.data(), mine.data(), bytes.size());
  ranks.gather(bytes, [&](int, const std::string& theirs) { all += theirs; });
  return all;
}

[[nodiscard]] inline std::vector<double> numbers_of(const std::string& bytes) {
  std::vector<double> numbers(bytes.size() / sizeof(double));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

/// Concatenates the numbers of all ranks, of any count each, in the order of the ranks, at every
/// rank. Collective.
[[nodiscard]] inline std::vector<double> concatenated(const Communicator& ranks,
                                                      const std::vector<double>& mine) {
  if (ranks.count() == 1) return mine;
  std::string all = gathered(ranks, mine);
  ranks.broadcast(all);
  return numbers_of(all);
}

}  // namespace peristat
