#pragma once

#include <algorithm>
#include <span>

namespace peristat {

/// Rule for the constants of an interaction between points of several materials.
enum class InterfaceRule {
  harmonic,    ///< n / sum 1/c: the halves of a bond in series
  arithmetic,  ///< sum c / n: side by side
  weaker       ///< the least
};

/// Mean of constants by a rule. A harmonic mean is 0 if one of them is 0; their signs must be the
/// same.
[[nodiscard]] inline double mean_by(InterfaceRule rule, std::span<const double> constants) {
  const double count = double(constants.size());
  if (rule == InterfaceRule::weaker) return *std::ranges::min_element(constants);
  double sum = 0.0;
  for (const double constant : constants) {
    if (rule == InterfaceRule::harmonic && constant == 0.0) return 0.0;
    sum += rule == InterfaceRule::harmonic ? 1.0 / constant : constant;
  }
  return rule == InterfaceRule::harmonic ? count / sum : sum / count;
}

}  // namespace peristat
