#include "src/materials/peak_factors.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "src/potentials/harmonic.hpp"

namespace peristat {
namespace {

/// Angles of the table. Below the least one compression prevails, and bodies of bonds have no peak.
constexpr double least = -75.0, most = 45.0;

/// Degrees between two angles, in 3D more: a pull takes longer.
double step_in(int dimension) { return dimension == 2 ? 7.5 : 15.0; }

double angle_of(double first, double second) {
  return std::atan2(second, first) * 180.0 / std::numbers::pi;
}

}  // namespace

PeakFactors::PeakFactors(const BulkPull& bulk, const AnyLaw& law, const MaterialStrength& strength)
    : bulk_(bulk), law_(law), strength_(strength) {
  const double work = law.work(Harmonic{1.0}, law.critical());
  strength_.factor[1] = std::min(strength.factor[1], law.largest_onset(work) / law.onset());
  const std::array<double, 2> pull{1.0, 0.0};
  uniaxial_ = bulk.peak(pull, law) / bulk.onset(pull, law);
  const double step = step_in(strength.dimension);
  for (double degrees = least; degrees <= most; degrees += step) {
    const double angle = degrees * std::numbers::pi / 180.0;
    factors_.push_back(onset({std::cos(angle), std::sin(angle)}).factor);
  }
}

PeakFactors::Onset PeakFactors::onset(const std::array<double, 2>& stresses) const {
  const double rho = strength_.surface.utilisation({stresses[0], stresses[1], 0.0});
  if (!(rho > 0.0)) return {strength_.factor[1], 1.0};
  const bool has_peak = angle_of(stresses[0], stresses[1]) > least - 1.0;
  const double first = bulk_.onset(stresses, law_);
  if (!std::isfinite(first)) return {0.0, 1.0};  // the stress drives no bond
  constexpr int turns = 2;
  Onset found{1.0, has_peak ? uniaxial_ : 1.0};
  for (int k = 0; k < turns && has_peak; ++k) {
    const MovingOnsets moving{[&](const std::array<double, 3>& strains) {
                                return found.factor * strength_.utilisation(strains);
                              },
                              strength_.factor};
    const double begins = bulk_.onset(stresses, law_, &moving);
    found.factor = bulk_.peak(stresses, law_, &moving) / begins;
  }
  found.chi = 1.0 / (first * rho * found.factor);
  return found;
}

double PeakFactors::at(const std::array<double, 3>& principal) const {
  std::array<double, 3> sorted = principal;
  std::ranges::sort(sorted, std::greater());
  const double other = std::abs(sorted[1]) > std::abs(sorted[2]) ? sorted[1] : sorted[2];
  const double last = double(factors_.size() - 1);
  const double place =
      std::clamp((angle_of(sorted[0], other) - least) / step_in(strength_.dimension), 0.0, last);
  const auto low = std::min(std::size_t(place), factors_.size() - 2);
  const double share = place - double(low);
  return (1.0 - share) * factors_[low] + share * factors_[low + 1];
}

PeakFactors::Strength PeakFactors::strength(const std::array<double, 2>& stresses) const {
  const double asked = 1.0 / strength_.surface.utilisation({stresses[0], stresses[1], 0.0});
  const auto [chi, factor] = onset(stresses);
  const double reached = asked * std::clamp(chi, strength_.factor[0], strength_.factor[1]) / chi;
  return {asked, reached, reached / factor};
}

}  // namespace peristat
