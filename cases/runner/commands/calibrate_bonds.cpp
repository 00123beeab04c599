#include "cases/runner/commands/calibrate_bonds.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "solvers/formulations/formulations.hpp"
#include "solvers/formulations/materials/bond_materials.hpp"
#include "solvers/formulations/materials/bond_potential.hpp"
#include "solvers/formulations/solid/solid_constants.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

std::string number(double value) {
  if (std::isfinite(value)) return fmt::format("{:.17g}", value);
  throw InputError("", "",
                   "the result is not finite: give a lattice and a material whose constants and "
                   "moduli are in the range of double precision");
}

std::string exact_pair(const char* key, double value) {
  return fmt::format("\"{}\": {}", key, number(value));
}

std::string object(const std::vector<std::string>& pairs) {
  return fmt::format("{{{}}}", fmt::join(pairs, ", "));
}

/// Lists a quantity along directions of the lattice: its axes and the diagonals between them.
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
  pairs.insert(pairs.begin(), exact_pair("mean", micromodulus / bulk_micromodulus(1.0, setting)));
  return object(pairs);
}

/// Fracture energies of cracks: mean, least and most, and those with normals along the lattice's
/// directions.
template <class OfPlane>
std::string fracture_energies(const DirectionalSpread& spread, int dimension,
                              const OfPlane& of_plane) {
  std::vector<std::string> pairs{exact_pair("mean", spread.mean), exact_pair("least", spread.least),
                                 exact_pair("most", spread.most)};
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

/// A stress; null where bonds never fail.
std::string stress_pair(const char* key, double stress) {
  return std::isinf(stress) ? fmt::format("\"{}\": null", key) : exact_pair(key, stress);
}

std::string over_directions(const DirectionalSpread& of) {
  return object(
      {stress_pair("mean", of.mean), stress_pair("least", of.least), stress_pair("most", of.most)});
}

/// Strengths on a surface, and those of the body; null where there are none.
std::string strengths_of_surface(const PeakFactors& factors) {
  const auto of = [&](const char* name, double first, double second) {
    const auto [asked, reached, onset] = factors.strength({first, second});
    if (!(asked > 0.0) || !std::isfinite(asked)) return fmt::format("\"{}\": null", name);
    return fmt::format("\"{}\": {}", name,
                       object({exact_pair("surface", asked), stress_pair("reached", reached),
                               stress_pair("onset", onset)}));
  };
  return object({of("uniaxial", 1.0, 0.0), of("biaxial", 1.0, 1.0), of("shear", 1.0, -1.0),
                 of("compression", 0.0, -1.0)});
}

/// Stresses at which bonds begin to soften and at which a body fails, for several states of stress.
std::string strengths(const DamageSpecification& damage, const BulkPull& pull, int dimension) {
  const AnyLaw law = law_of(damage);
  if (damage.peak_factors) return strengths_of_surface(*damage.peak_factors);
  const auto of = [&](const char* name, Loading loading) {
    std::vector<std::string> pairs{"\"onset\": " + over_directions(pull.onset(loading, law))};
    if (loading != Loading::compression) {
      pairs.push_back("\"peak\": " + over_directions(pull.peak(loading, law)));
    }
    return fmt::format("\"{}\": {}", name, object(pairs));
  };
  std::vector<std::string> all{of("uniaxial", Loading::tension)};
  if (dimension == 1) return object(all);
  all.push_back(of("biaxial", Loading::biaxial));
  all.push_back(of("shear", Loading::shear));
  all.push_back(of("compression", Loading::compression));
  return object(all);
}

std::string damage_section(const DamageSpecification& damage, const FractureScale& scale,
                           const std::optional<BulkBonds>& bonds, int dimension,
                           bool with_strengths) {
  const double per_area = scale.micromodulus * total_work(damage);
  const double energy = scale.energy(damage);
  std::vector<std::string> pairs;
  if (damage.softens()) pairs.push_back(exact_pair("onset", damage.onset));
  if (damage.law == DamageLaw::blended) pairs.push_back(exact_pair("peak", damage.peak));
  pairs.push_back(exact_pair("critical", damage.critical));
  const std::string energies = scale.tear
                                   ? fracture_energies(*scale.tear, law_of(damage), dimension)
                               : bonds ? fracture_energies(*bonds, per_area, dimension)
                               : scale.crossing > 0.0 ? number(energy)
                                                      : "null";
  pairs.push_back("\"fracture_energy\": " + energies);
  if (!scale.pull) return object(pairs);
  const DirectionalSpread strength = scale.pull->peak(Loading::tension, law_of(damage));
  if (strength.mean == 0.0) return object(pairs);
  if (std::isfinite(strength.mean)) pairs.push_back(exact_pair("strength", strength.mean));
  pairs.push_back("\"uniaxial_strength\": " + over_directions(strength));
  if (with_strengths) {
    pairs.push_back("\"strengths\": " + strengths(damage, *scale.pull, dimension));
  }
  if (scale.crossing == 0.0 || scale.youngs_modulus == 0.0 || std::isinf(strength.mean)) {
    return object(pairs);
  }
  pairs.push_back(exact_pair("characteristic_length",
                             scale.youngs_modulus * energy / (strength.mean * strength.mean)));
  pairs.push_back(
      exact_pair("largest_spacing", largest_spacing(damage, energy, strength.mean, scale)));
  return object(pairs);
}

std::vector<std::string> constants_of_bonds(const MaterialSpecification& material,
                                            const std::string& key, const BondSetting& setting) {
  if (material.fibre) {
    throw InputError(key + ".fibre", "",
                     "calibrate is for materials without fibres; check prints their constants");
  }
  const double modulus = micromodulus_of(material, key, setting).at(1.0);
  std::vector<std::string> pairs{
      exact_pair("micromodulus", modulus),
      exact_pair("continuum_youngs_modulus", youngs_modulus_of(modulus, setting))};
  if (setting.lattice) {
    pairs.push_back("\"youngs_modulus\": " + youngs_moduli(BulkBonds(setting), modulus, setting));
  }
  pairs.push_back(exact_pair("poisson_ratio", poisson_ratio(setting)));
  return pairs;
}

std::vector<std::string> constants_of_states(const MaterialSpecification& material,
                                             const BondSetting& setting) {
  const auto [lambda, mu] = lame_constants(material, setting.dimension);
  return {exact_pair("youngs_modulus", *material.youngs_modulus),
          exact_pair("poisson_ratio", *material.poisson_ratio), exact_pair("lambda", lambda),
          exact_pair("mu", mu)};
}

}  // namespace

void require_law(const DamageSpecification& damage, bool with_strengths) {
  if (!with_strengths || damage.breaks_bonds()) return;
  throw InputError("--strengths", "", "needs a law of damage by stretches");
}

std::string bond_calibration(const MaterialSpecification& material, const std::string& key,
                             const BondSetting& setting, double spacing, bool with_strengths) {
  std::vector<std::string> pairs = takes(material.model, Option::micromodulus)
                                       ? constants_of_bonds(material, key, setting)
                                       : constants_of_states(material, setting);
  require_law(material.damage, with_strengths);
  if (material.damage.law != DamageLaw::none) {
    pairs.push_back("\"damage\": " +
                    damage_calibration(material, key, setting, spacing, with_strengths));
  }
  return fmt::format("{{\n  {}\n}}\n", fmt::join(pairs, ",\n  "));
}

std::string damage_calibration(const MaterialSpecification& given, const std::string& key,
                               const BondSetting& setting, double spacing, bool with_strengths) {
  const MaterialSpecification material = with_fracture_energy(given, key, setting, spacing);
  if (material.damage.law == DamageLaw::energy_density) {
    return object(
        {exact_pair("energy_density", bearable_energy_density(material.damage, setting.horizon)),
         exact_pair("fracture_energy", *material.damage.fracture_energy)});
  }
  const FractureScale scale = fracture_scale_of(material, key, setting, spacing);
  std::optional<BulkBonds> bonds;
  if (setting.lattice && !takes(material.model, Option::constants)) {
    bonds.emplace(setting_of_bonds(formulation_of(material), setting));
  }
  return damage_section(damage_with_stretches(material, key, setting, spacing, scale), scale, bonds,
                        setting.dimension, with_strengths);
}

}  // namespace peristat
