#pragma once

#include <algorithm>

namespace peristat {

/// Brittle bond: undamaged below the critical stretch s_c, broken from it on ([GPMB] eq. 9). The
/// force jumps from c s_c to zero.
struct CriticalStretch {
  double critical_stretch = 0.0;  ///< s_c

  [[nodiscard]] double onset() const { return critical_stretch; }
  [[nodiscard]] double critical() const { return critical_stretch; }
  [[nodiscard]] double integrity(double s) const { return s < critical_stretch ? 1.0 : 0.0; }
  [[nodiscard]] double slope(double) const { return 0.0; }
  [[nodiscard]] double work(const auto& whole, double s) const {
    return whole(std::min(s, critical_stretch)).value;
  }
  /// Strength after a drop: the critical stretch, as for a broken bond.
  [[nodiscard]] double borne_after(double) const { return critical_stretch; }
  [[nodiscard]] CriticalStretch between(double, double critical) const { return {critical}; }
};

}  // namespace peristat
