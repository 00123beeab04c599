#include "assembly/terms/failure/strength_onsets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/dense/symmetric_spectrum.hpp"

namespace peristat {
namespace {

/// Principal strains of U - I with U^2 = F^T F, or of small displacements. From Green's strain, so
/// that small ones keep their digits.
template <int D>
std::array<double, D> principal_strains(const double* h, bool is_linear) {
  std::array<double, std::size_t(D) * D> green{};
  for (int r = 0; r < D; ++r) {
    for (int c = 0; c < D; ++c) {
      double product = 0.0;
      for (int k = 0; k < D; ++k) product += h[k * D + r] * h[k * D + c];
      green[std::size_t(r * D + c)] =
          0.5 * (h[r * D + c] + h[c * D + r] + (is_linear ? 0.0 : product));
    }
  }
  std::array<double, D> strains = symmetric_eigenvalues<D>(green.data());
  if (is_linear) return strains;
  for (double& of : strains) of = 2.0 * of / (1.0 + std::sqrt(std::max(1.0 + 2.0 * of, 0.0)));
  return strains;
}

template <int D>
std::array<double, 3> principal_stresses_in(const MaterialStrength& of, const double* gradient,
                                            double free, bool is_linear) {
  std::array<double, 3> stresses{};
  const std::array<double, D> strains = principal_strains<D>(gradient, is_linear);
  double trace = 0.0;
  for (const double strain : strains) trace += strain - free;
  for (int k = 0; k < D; ++k) {
    stresses[std::size_t(k)] =
        of.elastic.lambda * trace + 2.0 * of.elastic.mu * (strains[std::size_t(k)] - free);
  }
  if constexpr (D == 2) stresses[2] = of.across * (stresses[0] + stresses[1]);
  return stresses;
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
  const std::array<double, 3> stresses =
      principal_stresses(*material, dimension, displacement_gradient, free);
  const double of_peak = material->surface.utilisation(stresses);
  const double rho =
      of_peak * (material->peak_factors ? material->peak_factors->at(stresses) : 1.0);
  const bool can_start = rho > 0.0 && largest_stretch > 0.0;
  const double factor = factor_.empty() ? 1.0 : factor_[point];
  return {can_start ? factor * largest_stretch / rho : std::numeric_limits<double>::infinity(),
          material->factor};
}

std::array<double, 3> StrengthOnsets::principal_stresses(const MaterialStrength& of, int dimension,
                                                         const double* displacement_gradient,
                                                         double free) const {
  return dimension == 2 ? principal_stresses_in<2>(of, displacement_gradient, free, is_linear_)
                        : principal_stresses_in<3>(of, displacement_gradient, free, is_linear_);
}

}  // namespace peristat
