#include "solvers/formulations/bond/bond_constants.hpp"

#include <fmt/format.h>

#include "solvers/formulations/specification/for_each_material.hpp"
#include "solvers/formulations/specification/require.hpp"

namespace peristat {
namespace {

std::string text_of_fibres(const MaterialSpecification& material, const DirectedConstant& constant,
                           const BondSetting& setting) {
  const FibreSpecification& fibre = *material.fibre;
  const double along = *material.youngs_modulus, across = fibre.transverse_modulus;
  return fmt::format(
      "micromodulus {:.6g} N/m6 along the fibres, {:.6g} N/m6 across, at least {:.6g} N/m6; "
      "Young's moduli {:.6g} and {:.6g} Pa, shear modulus {:.6g} Pa",
      constant.at(1.0), constant.at(0.0), constant.least(), along, across,
      fibre.shear_modulus.value_or(natural_shear(along, across, setting)));
}

}  // namespace

void check_bond_constants(const MaterialSpecification& material, const std::string& key, int) {
  require(material.youngs_modulus.has_value() != material.micromodulus.has_value(), key, "",
          "needs a youngs_modulus or a micromodulus, and not both");
  require_absent(material.calibration && !material.youngs_modulus, key + ".calibration",
                 "needs youngs_modulus");
}

void require_lattice_to_calibrate_on(const BodySpecification& of, const Points& points) {
  for_each_material(of, [&](const MaterialSpecification& material, const std::string& key) {
    require(material.calibration != Calibration::lattice || points.lattice.has_value(),
            key + ".calibration", "\"lattice\"", "needs points on a lattice");
  });
}

Moduli moduli_of_bonds(const MaterialSpecification& material, const std::string& key,
                       const BondSetting& setting, double) {
  const double of_continuum =
      youngs_modulus_of(micromodulus_of(material, key, setting).at(1.0), setting);
  return {material.youngs_modulus.value_or(of_continuum), poisson_ratio(setting),
          setting.dimension == 2 && setting.plane == PlaneState::stress};
}

std::vector<MaterialLine> describe_bonds(const MaterialSpecification& material,
                                         const std::string& key, const BondSetting& setting,
                                         double) {
  const DirectedConstant constant = micromodulus_of(material, key, setting);
  if (material.fibre) return {{"constants", text_of_fibres(material, constant, setting)}};
  const double modulus = constant.at(1.0);
  return {
      {"constants",
       fmt::format("micromodulus {:.6g} N/m6, Young's modulus {:.6g} Pa, Poisson's ratio {:.4g}",
                   modulus, youngs_modulus_of(modulus, setting), poisson_ratio(setting))}};
}

}  // namespace peristat
