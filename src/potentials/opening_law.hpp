#pragma once

#include "src/potentials/harmonic.hpp"

namespace peristat {

/// Softening curves of concrete: the stress sigma over the strength f_t at a crack of opening w,
/// the share x = w/w_c of the opening at which no stress is left:
///
///   bilinear     1 - 3 x up to x = 2/9, then 3/7 (1 - x): a kink at a third of the strength and at
///                0.8 G_F/f_t, and w_c = 3.6 G_F/f_t [Petersson 1981]
///   cornelissen  (1 + (c1 x)^3) exp(-c2 x) - x (1 + c1^3) exp(-c2), c1 = 3, c2 = 6.93,
///                w_c = 5.136 G_F/f_t [Cornelissen et al. 1986]
///
/// Both are convex and steepest at x = 0.
enum class OpeningCurve { bilinear, cornelissen };

/// Bond that a crack opens: the force c f falls with the opening, and what is not opening is the
/// elastic stretch f of the bond, as of a cohesive crack in series with an elastic body,
///
///   f = s_m g(x),   s = f + x s_c     for s_m < s < s_c
///
/// with g of a curve, the onset s_m, and the critical stretch s_c, which is the opening at which
/// the force is zero: no elastic stretch is left there. So the work of the opening is that of the
/// bond, as the elastic part gives its energy back,
///
///   M(s) = s_m s_c int_0^x g + f^2/2,   M(s_c) = s_m s_c int_0^1 g: 5/18 s_m s_c, or 0.1947 s_m
///   s_c
///
/// and the ratios of strength, openings and fracture energy are those of the curve. (If the share x
/// were that of the range from s_m to s_c, the elastic energy s_m^2/2 would come on top.) The
/// stretch grows with the opening only if s_m/s_c < 1/|g'(0)|: `largest_onset_of`. T = f/s.
struct OpeningLaw {
  double onset_stretch = 0.0;     ///< s_m > 0
  double critical_stretch = 0.0;  ///< s_c
  OpeningCurve curve = OpeningCurve::bilinear;

  [[nodiscard]] double onset() const { return onset_stretch; }
  [[nodiscard]] double critical() const { return critical_stretch; }
  [[nodiscard]] double integrity(double s) const;
  [[nodiscard]] double slope(double s) const;

  /// For the modulus 1, in closed form.
  [[nodiscard]] double work(const Harmonic& whole, double s) const;

  /// The same law between other stretches.
  [[nodiscard]] OpeningLaw between(double onset, double critical) const {
    return {onset, critical, curve};
  }

  /// Largest onset with which it takes a work without a snap-back, see largest_onset_of.
  [[nodiscard]] double largest_onset(double work) const;

  /// Stretch at a share x of the opening.
  [[nodiscard]] double stretch_at(double share) const;
};

/// s_m/s_c from which on a bond would snap back: 1/3, or 0.1437.
[[nodiscard]] double largest_onset_of(OpeningCurve curve);

/// Share x at which the slope of the bilinear curve jumps.
inline constexpr double kink_of_bilinear = 2.0 / 9.0;

}  // namespace peristat
