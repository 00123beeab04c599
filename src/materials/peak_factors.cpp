#include "src/materials/peak_factors.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "src/potentials/critical_of_work.hpp"

namespace peristat {
namespace {

/// Angles of the table. Below the least one compression prevails, and bodies of bonds have no peak.
constexpr double least = -75.0, step = 15.0;
constexpr int count = 9;

/// Factor under one ratio of stresses. The surface moves the onset of all bonds by the factor chi,
/// which depends on the result.
/// @param strength of the first bond without the surface, of unit stresses
double factor_of(const BulkPull& bulk, const AnyLaw& law, const std::array<double, 2>& stresses,
                 double rho, double guess) {
  const double work = law.work(Harmonic{1.0}, law.critical());
  const double first = bulk.course(stresses, {CriticalStretch{law.onset()}}).onset;
  const double most = std::sqrt(2.0 * work) / law.onset();
  constexpr int turns = 2;
  double factor = guess;
  for (int k = 0; k < turns; ++k) {
    const double onset = std::min(1.0 / (first * rho * factor), most) * law.onset();
    const double critical = critical_of_work(bond_law(law), onset, work, law.critical());
    const auto [begins, largest] = bulk.course(stresses, law.between(onset, critical));
    factor = largest / begins;
  }
  return factor;
}

}  // namespace

PeakFactors::PeakFactors(const BulkPull& bulk, const AnyLaw& law, const StrengthSurface& surface) {
  const auto [onset, peak] = bulk.course({1.0, 0.0}, law);
  for (int k = 0; k < count; ++k) {
    const double angle = (least + k * step) * std::numbers::pi / 180.0;
    const std::array<double, 2> stresses{std::cos(angle), std::sin(angle)};
    const double rho = surface.utilisation({stresses[0], stresses[1], 0.0});
    factors_.push_back(rho > 0.0 ? factor_of(bulk, law, stresses, rho, peak / onset) : 1.0);
  }
}

double PeakFactors::at(const std::array<double, 3>& principal) const {
  std::array<double, 3> sorted = principal;
  std::ranges::sort(sorted, std::greater());
  const double other = std::abs(sorted[1]) > std::abs(sorted[2]) ? sorted[1] : sorted[2];
  const double angle = std::atan2(other, sorted[0]) * 180.0 / std::numbers::pi;
  const double place = std::clamp((angle - least) / step, 0.0, double(count - 1));
  const auto low = std::min(std::size_t(place), std::size_t(count - 2));
  const double share = place - double(low);
  return (1.0 - share) * factors_[low] + share * factors_[low + 1];
}

}  // namespace peristat
