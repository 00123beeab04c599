#include "src/core/nearest_name.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace peristat {
namespace {

/// Damerau-Levenshtein distance by dynamic programming over prefixes; three rows are kept because a
/// swap looks back two rows. No part is edited twice ("optimal string alignment").
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before_last, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last = last;
    last = row;
  }
  return last[b.size()];
}

}  // namespace

std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates) {
  const std::size_t limit = std::max<std::size_t>(2, name.size() / 3);
  const std::string* nearest = nullptr;
  std::size_t least = limit + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate);
    // A distance as long as the longer name keeps no character of it: no resemblance at all.
    const bool resembles = distance < std::max(name.size(), candidate.size()) || distance == 0;
    if (distance < least && resembles) {
      least = distance;
      nearest = &candidate;
    }
  }
  return nearest ? *nearest : std::string();
}

}  // namespace peristat
