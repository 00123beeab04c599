#include "src/potentials/opening_law.hpp"

#include <cmath>

namespace peristat {
namespace {

/// g, its slope, and its integral from 0, at a share x of the opening.
struct OnOpening {
  double force, slope, area;
};

constexpr double c1_cubed = 27.0, c2 = 6.93;

OnOpening bilinear_at(double x) {
  if (x <= kink_of_bilinear) return {1.0 - 3.0 * x, -3.0, x * (1.0 - 1.5 * x)};
  constexpr double whole_area = 5.0 / 18.0;
  const double left = 1.0 - x;
  return {3.0 / 7.0 * left, -3.0 / 7.0, whole_area - 1.5 / 7.0 * left * left};
}

OnOpening cornelissen_at(double x) {
  const double fall = std::exp(-c2 * x), end = (1.0 + c1_cubed) * std::exp(-c2);
  const double cube = c1_cubed * x * x * x;
  // int_0^x r^3 exp(-c2 r) dr
  const double of_cube =
      (6.0 * -std::expm1(-c2 * x) - fall * c2 * x * (6.0 + c2 * x * (3.0 + c2 * x))) /
      (c2 * c2 * c2 * c2);
  return {(1.0 + cube) * fall - end * x, (3.0 * c1_cubed * x * x - c2 * (1.0 + cube)) * fall - end,
          -std::expm1(-c2 * x) / c2 + c1_cubed * of_cube - 0.5 * end * x * x};
}

OnOpening curve_at(OpeningCurve curve, double x) {
  return curve == OpeningCurve::bilinear ? bilinear_at(x) : cornelissen_at(x);
}

double bilinear_share(double ratio, double stretch) {
  const double steep = (stretch - ratio) / (1.0 - 3.0 * ratio);
  if (steep <= kink_of_bilinear) return steep;
  return (stretch - 3.0 / 7.0 * ratio) / (1.0 - 3.0 / 7.0 * ratio);
}

/// Solves ratio g(x) + x = stretch. The left-hand side is convex and increasing, so that Newton's
/// method from the right descends to the solution, and has it when it no longer descends.
double cornelissen_share(double ratio, double stretch) {
  double x = stretch;
  constexpr int most = 100;
  for (int k = 0; k < most; ++k) {
    const OnOpening at = cornelissen_at(x);
    const double next = x - (ratio * at.force + x - stretch) / (ratio * at.slope + 1.0);
    if (!(next < x)) break;
    x = next;
  }
  return x;
}

/// Share of the opening at a stretch between onset and critical stretch.
double share_of(const OpeningLaw& law, double s) {
  const double ratio = law.onset_stretch / law.critical_stretch, stretch = s / law.critical_stretch;
  return law.curve == OpeningCurve::bilinear ? bilinear_share(ratio, stretch)
                                             : cornelissen_share(ratio, stretch);
}

}  // namespace

double OpeningLaw::stretch_at(double share) const {
  return onset_stretch * curve_at(curve, share).force + share * critical_stretch;
}

double OpeningLaw::integrity(double s) const {
  if (s <= onset_stretch) return 1.0;
  if (s >= critical_stretch) return 0.0;
  return onset_stretch * curve_at(curve, share_of(*this, s)).force / s;
}

double OpeningLaw::slope(double s) const {
  if (s <= onset_stretch || s >= critical_stretch) return 0.0;
  const OnOpening at = curve_at(curve, share_of(*this, s));
  const double per_opening = onset_stretch / critical_stretch * at.slope;
  return (per_opening / (1.0 + per_opening) - onset_stretch * at.force / s) / s;
}

double OpeningLaw::work(const Harmonic&, double s) const {
  if (s <= onset_stretch) return 0.5 * s * s;
  const OnOpening at = curve_at(curve, s >= critical_stretch ? 1.0 : share_of(*this, s));
  return onset_stretch * (critical_stretch * at.area + 0.5 * onset_stretch * at.force * at.force);
}

double OpeningLaw::largest_onset(double work) const {
  constexpr double below = 1.0 - 1e-9;
  return below * std::sqrt(largest_onset_of(curve) * work / curve_at(curve, 1.0).area);
}

double largest_onset_of(OpeningCurve curve) { return -1.0 / curve_at(curve, 0.0).slope; }

}  // namespace peristat
