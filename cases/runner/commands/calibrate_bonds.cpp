#include "cases/runner/commands/calibrate_bonds.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "solvers/study/bond_materials.hpp"
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

std::string spread(const DirectionalSpread& of, double factor) {
  return object({pair("mean", factor * of.mean), pair("least", factor * of.least),
                 pair("most", factor * of.most)});
}

/// Young's moduli along some directions of the lattice's axes.
std::string moduli(const BulkBonds& bonds, double micromodulus,
                   const std::vector<Coordinates>& directions) {
  std::vector<std::string> values;
  for (const Coordinates& direction : directions) {
    values.push_back(number(micromodulus * bonds.youngs_modulus(bonds.turned(direction))));
  }
  return fmt::format("[{}]", fmt::join(values, ", "));
}

std::string youngs_moduli(const BulkBonds& bonds, double micromodulus, const BondSetting& setting) {
  const Coordinates x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const double mean = micromodulus / bulk_micromodulus(1.0, setting);
  switch (setting.dimension) {
    case 1:
      return object({pair("mean", mean), "\"axes\": " + moduli(bonds, micromodulus, {x})});
    case 2:
      return object({pair("mean", mean), "\"axes\": " + moduli(bonds, micromodulus, {x, y}),
                     "\"diagonal\": " + moduli(bonds, micromodulus, {{1, 1, 0}})});
    default:
      return object(
          {pair("mean", mean), "\"axes\": " + moduli(bonds, micromodulus, {x, y, z}),
           "\"face_diagonals\": " + moduli(bonds, micromodulus, {{0, 1, 1}, {1, 0, 1}, {1, 1, 0}}),
           "\"space_diagonal\": " + moduli(bonds, micromodulus, {{1, 1, 1}})});
  }
}

std::string damage_section(const DamageSpecification& damage, const FractureScale& scale,
                           const std::optional<BulkBonds>& bonds) {
  const double per_area = scale.micromodulus * total_work(damage), peak = peak_force(damage);
  const double energy = per_area * scale.crossing, strength = scale.youngs_modulus * peak;
  std::vector<std::string> pairs;
  if (damage.softens()) pairs.push_back(pair("onset", damage.onset));
  if (damage.law == DamageLaw::blended) pairs.push_back(pair("peak", damage.peak));
  pairs.push_back(pair("critical", damage.critical));
  pairs.push_back("\"fracture_energy\": " +
                  (bonds ? spread(bonds->crossing(), per_area) : number(energy)));
  pairs.push_back(pair("strength", strength));
  if (bonds) {
    pairs.push_back("\"stress_at_peak\": " +
                    spread(bonds->stress_at_unit_stretch(), scale.micromodulus * peak));
  }
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
    const DamageSpecification damage = with_stretches(material.damage, key, scale);
    pairs.push_back("\"damage\": " + damage_section(damage, scale, bonds));
  }
  return fmt::format("{{\n  {}\n}}\n", fmt::join(pairs, ",\n  "));
}

}  // namespace peristat
