#include "assembly/terms/failure/strength_onsets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/dense/symmetric_spectrum.hpp"

namespace peristat {
namespace {

/// Principal strains of U - I with U^2 = F^T F, or of small displacements, less a free stretch.
/// From Green's strain, so that small ones keep their digits.
template <int D>
std::array<double, 3> principal_strains(const double* h, double free) {
  std::array<double, std::size_t(D) * D> green{};
  for (int r = 0; r < D; ++r) {
    for (int c = 0; c < D; ++c) {
      double product = 0.0;
      for (int k = 0; k < D; ++k) product += h[k * D + r] * h[k * D + c];
      green[std::size_t(r * D + c)] = 0.5 * (h[r * D + c] + h[c * D + r] + product);
    }
  }
  std::array<double, 3> strains{};
  std::ranges::copy(symmetric_eigenvalues<D>(green.data()), strains.begin());
  for (double& of : strains) {
    of = 2.0 * of / (1.0 + std::sqrt(std::max(1.0 + 2.0 * of, 0.0)));
    of -= free;
  }
  return strains;
}

}  // namespace

double StrengthOnsets::PointOnset::of_bond(double onset, double most_of_law) const {
  if (!factor) return onset;
  const auto [least, most] = *factor;
  return std::clamp(stretch, least * onset, std::min(most, most_of_law) * onset);
}

StrengthOnsets::PointOnset StrengthOnsets::of_point(std::size_t point, int dimension,
                                                    const double* displacement_gradient,
                                                    double free, double largest_stretch) const {
  const auto& material = materials_[of_point_.empty() ? 0 : of_point_[point]];
  if (!material) return {};
  const std::array<double, 3> strains = dimension == 2
                                            ? principal_strains<2>(displacement_gradient, free)
                                            : principal_strains<3>(displacement_gradient, free);
  const std::array<double, 3> stresses = material->of.stresses(strains);
  const double to_peak = material->peak_factors ? material->peak_factors->at(stresses) : 1.0;
  const double rho = to_peak * material->of.surface.utilisation(stresses);
  const bool can_start = rho > 0.0 && largest_stretch > 0.0;
  const double factor = factor_.empty() ? 1.0 : factor_[point];
  return {can_start ? factor * largest_stretch / rho : std::numeric_limits<double>::infinity(),
          material->of.factor};
}

}  // namespace peristat
