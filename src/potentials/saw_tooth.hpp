#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace peristat {

/// The secants of a saw-tooth, from the undamaged bond to the last secant with any stiffness.
/// Stretches are in units of the critical one.
struct Teeth {
  std::vector<double> strength;   ///< stretch s_k at which a bond leaves its secant, ascending
  std::vector<double> integrity;  ///< T_k of the secants, from 1 downwards
  /// Largest force above the law's at the same stretch, over the law's largest force.
  double band = 0.0;
  /// Largest force over the law's largest, minus 1: the strength is overestimated by this.
  double excess_strength = 0.0;
};

/// A law of damage whose force falls smoothly, as a saw-tooth: a bond follows a secant of integrity
/// T_k up to the stretch s_k, and drops to the next one there (the ripples of sequentially linear
/// analysis: Rots and Invernizzi, Int. J. Numer. Anal. Meth. Geomech. 28, 2004). Between events
/// such a bond is elastic.
///
/// The secants are those of the law at stretches kappa_0 = s_m < kappa_1 < ... < kappa_n = s_c, and
///
///   (T_k - T_(k+1)) phi_0(s_k) = D(kappa_(k+1)) - D(kappa_k),   D(kappa) = int_0^kappa T phi_0' dr
///                                                                        - T(kappa) phi_0(kappa),
///
/// so that every drop dissipates exactly what the law does between the two secants; s_k then lies
/// between their stretches. The kappa_k are chosen so that the force exceeds the law's by the same
/// multiple of max(0.1, 1 - T_k) each time, the least that so many teeth allow.
///
/// The history of a bond is the strength of its present secant, or the critical stretch if it is
/// broken.
struct SawTooth {
  std::shared_ptr<const Teeth> teeth;
  double critical_stretch = 0.0;  ///< s_c

  [[nodiscard]] double onset() const { return teeth->strength.front() * critical_stretch; }
  [[nodiscard]] double critical() const { return critical_stretch; }
  [[nodiscard]] double integrity(double s) const {
    const std::size_t tooth = tooth_at(s);
    return tooth < teeth->integrity.size() ? teeth->integrity[tooth] : 0.0;
  }
  [[nodiscard]] double slope(double) const { return 0.0; }
  [[nodiscard]] double work(const auto& whole, double s) const {
    double sum = 0.0, before = 0.0;
    for (std::size_t k = 0; k < teeth->strength.size() && before < s; ++k) {
      const double end = std::min(s, teeth->strength[k] * critical_stretch);
      sum += teeth->integrity[k] * (whole(end).value - whole(before).value);
      before = end;
    }
    return sum;
  }
  /// The same law between stretches of the same ratio.
  [[nodiscard]] SawTooth between(double, double critical) const { return {teeth, critical}; }

  /// Strength after a drop from the secant with the given strength: that of the next secant, or the
  /// critical stretch of a broken bond.
  [[nodiscard]] double borne_after(double strength) const {
    const std::size_t next = tooth_at(strength) + 1;
    return next < teeth->strength.size() ? teeth->strength[next] * critical_stretch
                                         : critical_stretch;
  }

 private:
  /// Number of the secant on which a stretch lies; beyond the last, the number of secants.
  [[nodiscard]] std::size_t tooth_at(double s) const {
    // A strength that was multiplied and divided by the critical stretch is still the same one.
    constexpr double round_off = 1e-12;
    const auto& strengths = teeth->strength;
    const double share = s / critical_stretch * (1.0 - round_off);
    return std::size_t(std::lower_bound(strengths.begin(), strengths.end(), share) -
                       strengths.begin());
  }
};

}  // namespace peristat
