#include "src/potentials/critical_of_work.hpp"

#include <algorithm>
#include <cmath>

namespace peristat {

double critical_of_work(const AnyBondLaw& law, double onset, double work, double guess) {
  constexpr double round_off = 4e-16;
  constexpr int most_trials = 100;
  const Harmonic whole{1.0};
  const auto excess = [&](double critical) {
    return law.between(onset, critical).work(whole, critical) - work;
  };
  // The work grows with the critical stretch, at most by the whole force of the onset.
  double low = onset * (1.0 + 1e-12), high = 0.0;  // 0: not known yet
  double critical = std::max(guess, low), slope = 0.5 * onset;
  for (int k = 0; k < most_trials; ++k) {
    const double found = excess(critical);
    if (std::abs(found) <= round_off * work) break;
    (found < 0.0 ? low : high) = critical;
    double next = critical - found / slope;
    if (high == 0.0) {
      next = std::max(next, low);
    } else if (!(next > low && next < high)) {
      next = 0.5 * (low + high);
    }
    if (std::abs(next - critical) <= round_off * critical) break;
    const double secant = (excess(next) - found) / (next - critical);
    if (secant > 0.0) slope = secant;
    critical = next;
  }
  return critical;
}

}  // namespace peristat
