#include "src/materials/strength_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace peristat {
namespace {

double drucker_prager(const std::array<double, 3>& s, double tension, double compression) {
  const double i1 = s[0] + s[1] + s[2];
  const auto squared = [](double x) { return x * x; };
  const double j2 = (squared(s[0] - s[1]) + squared(s[1] - s[2]) + squared(s[2] - s[0])) / 6.0;
  const double share = tension / compression;  // 0 if no compression is a strength
  const double g0 = 2.0 * tension, g1 = 1.0 - share;
  return (std::numbers::sqrt3 * (1.0 + share) * std::sqrt(j2) + g1 * i1) / g0;
}

}  // namespace

double StrengthSurface::utilisation(const std::array<double, 3>& principal) const {
  const auto [least, most] = std::ranges::minmax(principal);
  const double pulls = std::max(most, 0.0) / tension;
  switch (criterion) {
    case StrengthCriterion::rankine:
      return pulls;
    case StrengthCriterion::mohr_coulomb:
      return pulls - std::min(least, 0.0) / compression;
    case StrengthCriterion::drucker_prager:
      return drucker_prager(principal, tension, compression);
    case StrengthCriterion::none:
      break;
  }
  return 0.0;
}

double compressive_strength(double tension, double biaxial) {
  return tension * biaxial / (3.0 * biaxial - 2.0 * tension);
}

}  // namespace peristat
