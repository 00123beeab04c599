#include "solvers/formulations/solid/solid_constants.hpp"

#include <fmt/format.h>

#include "solvers/formulations/specification/require.hpp"
#include "src/materials/poisson_ratio_limits.hpp"

namespace peristat {

LamePair lame_constants(const MaterialSpecification& material, int dimension) {
  return lame_constants(*material.youngs_modulus, *material.poisson_ratio, dimension,
                        material.plane);
}

void check_solid_constants(const MaterialSpecification& material, const std::string& key,
                           int dimension) {
  require(material.youngs_modulus.has_value(), key + ".youngs_modulus", "", "is missing");
  require(material.poisson_ratio.has_value(), key + ".poisson_ratio", "", "is missing");
  const double nu = *material.poisson_ratio;
  require(nu > -1.0 && nu < 0.5, key + ".poisson_ratio", number_text(nu),
          "must be above -1 and below 0.5");
  // In plane stress 1/2 is no incompressible limit.
  const bool is_plane_stress = dimension == 2 && material.plane == PlaneState::stress;
  require(1.0 + nu >= least_distance_of_poisson_ratio &&
              (is_plane_stress || 1.0 - 2.0 * nu >= least_distance_of_poisson_ratio),
          key + ".poisson_ratio", number_text(nu),
          "is so near its limit that too few digits of double precision are left: take at most "
          "0.49999995, and at least -0.9999999");
}

std::vector<MaterialLine> describe_solid(const MaterialSpecification& material, const std::string&,
                                         const BondSetting& setting, double) {
  const auto [lambda, mu] = lame_constants(material, setting.dimension);
  return {{"constants", fmt::format("lambda {:.6g} Pa, mu {:.6g} Pa", lambda, mu)}};
}

Moduli moduli_of_solid(const MaterialSpecification& material, const std::string&,
                       const BondSetting& setting, double) {
  return {*material.youngs_modulus, *material.poisson_ratio,
          setting.dimension == 2 && material.plane == PlaneState::stress};
}

double modulus_of_crack(double crack_energy, const BondSetting& setting) {
  return 4.0 * crack_energy / (mean_of_magnitude(setting.dimension) * setting.moment(2));
}

std::vector<LamePair> constants_of_points(const ModelSetting& setting) {
  std::vector<LamePair> of_material, of_points;
  for (const auto& material : setting.materials.all()) {
    of_material.push_back(lame_constants(*material.of, setting.points.dimension));
  }
  const std::vector<double>& factors = setting.factors.stiffness;
  for (Index i = 0; i < setting.points.count(); ++i) {
    const auto& [lambda, mu] = of_material[setting.materials.of(i)];
    const double factor = factors.empty() ? 1.0 : factors[std::size_t(i)];
    of_points.push_back({factor * lambda, factor * mu});
  }
  return of_points;
}

}  // namespace peristat
