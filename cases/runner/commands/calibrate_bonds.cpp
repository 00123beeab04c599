#include "cases/runner/commands/calibrate_bonds.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "solvers/study/bond_materials.hpp"
#include "solvers/study/bond_potential.hpp"
#include "solvers/study/fracture_data.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.17g}", value) : "null";
}

std::string pair(const char* key, double value) {
  return fmt::format("\"{}\": {}", key, number(value));
}

std::string object(const std::vector<std::string>& pairs) {
  return fmt::format("{{{}}}", fmt::join(pairs, ", "));
}

/// A quantity of directions of the lattice: its axes and the diagonals between them.
template <class Quantity>
std::vector<std::string> of_directions(int dimension, const Quantity& quantity) {
  const Coordinates x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const auto list = [&](const char* key, const std::vector<Coordinates>& directions) {
    std::vector<std::string> values;
    for (const Coordinates& direction : directions) {
      values.push_back(number(quantity(direction)));
    }
    return fmt::format("\"{}\": [{}]", key, fmt::join(values, ", "));
  };
  if (dimension == 1) return {list("axes", {x})};
  if (dimension == 2) return {list("axes", {x, y}), list("diagonals", {{1, 1, 0}, {-1, 1, 0}})};
  return {list("axes", {x, y, z}), list("face_diagonals", {{0, 1, 1}, {1, 0, 1}, {1, 1, 0}}),
          list("space_diagonal", {{1, 1, 1}})};
}

std::string youngs_moduli(const BulkBonds& bonds, double micromodulus, const BondSetting& setting) {
  std::vector<std::string> pairs = of_directions(setting.dimension, [&](const Coordinates& n) {
    return micromodulus * bonds.youngs_modulus(bonds.turned(n));
  });
  pairs.insert(pairs.begin(), pair("mean", micromodulus / bulk_micromodulus(1.0, setting)));
  return object(pairs);
}

/// Of cracks whose normals have these directions.
template <class OfPlane>
std::string fracture_energies(const DirectionalSpread& spread, int dimension,
                              const OfPlane& of_plane) {
  std::vector<std::string> pairs{pair("mean", spread.mean), pair("least", spread.least),
                                 pair("most", spread.most)};
  for (auto& of : of_directions(dimension, of_plane)) pairs.push_back(of);
  return object(pairs);
}

std::string fracture_energies(const BulkBonds& bonds, double per_area, int dimension) {
  DirectionalSpread spread = bonds.crossing();
  for (double* value : {&spread.mean, &spread.least, &spread.most}) *value *= per_area;
  return fracture_energies(spread, dimension, [&](const Coordinates& n) {
    return per_area * bonds.crossing(bonds.turned(n));
  });
}

std::string fracture_energies(const CpdTear& tear, const AnyLaw& law, int dimension) {
  return fracture_energies(tear.spread(law), dimension,
                           [&](const Coordinates& n) { return tear.energy(law, n); });
}

std::string damage_section(const DamageSpecification& damage, const FractureScale& scale,
                           const std::optional<BulkBonds>& bonds, int dimension) {
  const double per_area = scale.micromodulus * total_work(damage), peak = peak_force(damage);
  const double energy = scale.energy(damage), strength = scale.youngs_modulus * peak;
  std::vector<std::string> pairs;
  if (damage.softens()) pairs.push_back(pair("onset", damage.onset));
  if (damage.law == DamageLaw::blended) pairs.push_back(pair("peak", damage.peak));
  pairs.push_back(pair("critical", damage.critical));
  const std::string energies = scale.tear
                                   ? fracture_energies(*scale.tear, law_of(damage), dimension)
                               : bonds ? fracture_energies(*bonds, per_area, dimension)
                                       : number(scale.crossing > 0.0 ? energy : NAN);
  pairs.push_back("\"fracture_energy\": " + energies);
  if (strength == 0.0) return object(pairs);  // nothing but constants is known
  pairs.push_back(pair("strength", strength));
  if (bonds) {
    const DirectionalSpread stress = bonds->stress_at_unit_stretch();
    const double factor = scale.micromodulus * peak;
    pairs.push_back("\"stress_at_peak\": " + object({pair("mean", factor * stress.mean),
                                                     pair("least", factor * stress.least),
                                                     pair("most", factor * stress.most)}));
  }
  if (scale.crossing == 0.0) return object(pairs);
  pairs.push_back(
      pair("characteristic_length", scale.youngs_modulus * energy / (strength * strength)));
  pairs.push_back(pair("largest_spacing", largest_spacing(energy, strength, scale)));
  return object(pairs);
}

}  // namespace

std::string bond_calibration(const MaterialSpecification& material, const std::string& key,
                             const BondSetting& setting, double spacing) {
  if (material.fibre) {
    throw InputError(key + ".fibre", "",
                     "calibrate is for materials without fibres; check tells their constants");
  }
  const FractureScale scale = FractureScale::of(material, key, setting, spacing);
  std::optional<BulkBonds> bonds;
  if (setting.lattice) bonds.emplace(setting);
  std::vector<std::string> pairs{
      pair("micromodulus", scale.micromodulus),
      pair("continuum_youngs_modulus", youngs_modulus_of(scale.micromodulus, setting))};
  if (bonds) {
    pairs.push_back("\"youngs_modulus\": " + youngs_moduli(*bonds, scale.micromodulus, setting));
  }
  pairs.push_back(pair("poisson_ratio", poisson_ratio(setting)));
  if (material.damage.law != DamageLaw::none) {
    pairs.push_back("\"damage\": " + damage_calibration(material, key, setting, spacing));
  }
  return fmt::format("{{\n  {}\n}}\n", fmt::join(pairs, ",\n  "));
}

std::string damage_calibration(const MaterialSpecification& material, const std::string& key,
                               const BondSetting& setting, double spacing) {
  if (material.damage.law == DamageLaw::energy_density) {
    return object(
        {pair("energy_density", bearable_energy_density(material.damage, setting.horizon)),
         pair("fracture_energy", *material.damage.fracture_energy)});
  }
  const FractureScale scale = FractureScale::of(material, key, setting, spacing);
  std::optional<BulkBonds> bonds;
  if (setting.lattice && material.model == MaterialModel::bond) bonds.emplace(setting);
  return damage_section(with_stretches(material.damage, key, scale), scale, bonds,
                        setting.dimension);
}

}  // namespace peristat
