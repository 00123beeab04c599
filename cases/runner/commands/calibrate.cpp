#include "cases/runner/commands/calibrate.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cases/runner/commands/calibrate_bonds.hpp"
#include "cases/runner/setup/body.hpp"
#include "solvers/formulations/check_specification.hpp"
#include "solvers/formulations/cpd/cpd.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/formulations/materials/bond_materials.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/neighbourhood/bulk_neighbourhood.hpp"

namespace peristat {
namespace {

/// Option for a key: "--youngs-modulus" for "youngs_modulus".
std::string option(std::string key) {
  for (char& c : key) {
    if (c == '_') c = '-';
  }
  return "--" + key;
}

void require_positive(const std::string& key, double value) {
  if (value > 0.0 && std::isfinite(value)) return;
  throw InputError(option(key), number_text(value), "must be a positive number");
}

void require_finite(const std::string& key, const std::optional<double>& value) {
  if (!value || std::isfinite(*value)) return;
  throw InputError(option(key), number_text(*value), "must be a finite number");
}

/// Checks that exactly one way to describe the material was chosen, completely.
void check(const CalibrationQuestion& question) {
  if (question.dimension != 2 && question.dimension != 3) {
    throw InputError("--dimension", std::to_string(question.dimension), "must be 2 or 3");
  }
  require_positive("spacing", question.spacing);
  require_positive("horizon_ratio", question.horizon_ratio);
  require_positive("thickness", question.thickness);
  const double largest = largest_ratio_with_pairs(question.dimension);
  if (question.horizon_ratio < 1.5 || question.horizon_ratio > largest) {
    throw InputError("--horizon-ratio", number_text(question.horizon_ratio),
                     "must be between 1.5 (below it no neighbours of a point are neighbours of "
                     "each other) and " +
                         number_text(largest));
  }
  if (question.dimension == 3 && question.thickness != 1.0) {
    throw InputError("--thickness", number_text(question.thickness), "is for --dimension 2");
  }
  const bool young = question.youngs_modulus || question.poisson_ratio;
  const bool lame = question.lambda || question.mu;
  const bool constants = question.c1 || question.c3;
  if (int(young) + int(lame) + int(constants) != 1) {
    throw InputError("", "",
                     "calibrate needs exactly one of --youngs-modulus with --poisson-ratio, "
                     "--lambda with --mu, or --c1 with --c2 and --c3");
  }
  const auto require_both = [](const char* first, bool has_first, const char* second,
                               bool has_second) {
    if (has_first != has_second) {
      throw InputError(option(has_first ? second : first), "", "is missing");
    }
  };
  if (young) {
    require_both("youngs_modulus", question.youngs_modulus.has_value(), "poisson_ratio",
                 question.poisson_ratio.has_value());
  }
  if (lame) {
    require_both("lambda", question.lambda.has_value(), "mu", question.mu.has_value());
  }
  if (constants && !question.c1) throw InputError("--c1", "", "is missing");
  if (constants) require_positive("c1", *question.c1);
  if (!constants && question.dimension == 2 && question.c2) {
    throw InputError("--c2", number_text(*question.c2), "follows from the moduli in 2D");
  }
  if (question.dimension == 2 && question.c3.value_or(0.0) != 0.0) {
    throw InputError("--c3", number_text(*question.c3), "must be 0 in 2D");
  }
  require_finite("youngs_modulus", question.youngs_modulus);
  require_finite("poisson_ratio", question.poisson_ratio);
  require_finite("lambda", question.lambda);
  require_finite("mu", question.mu);
  require_finite("c2", question.c2);
  require_finite("c3", question.c3);
  if (!question.lambda) return;
  try {
    require_stable({*question.lambda, *question.mu}, question.dimension);
  } catch (const InputError& error) {
    throw InputError(option(error.key()), error.value(), error.allowed());
  }
}

CpdConstants constants_of(const CalibrationQuestion& question, const CpdStiffness& stiffness) {
  const double c2 = question.c2.value_or(0.0);
  if (question.c1) return {*question.c1, c2, question.c3.value_or(0.0)};
  LameModuli moduli;
  if (question.lambda) {
    moduli = {*question.lambda, *question.mu};
    require_stable(moduli, question.dimension);
  } else {
    moduli = lame_moduli(*question.youngs_modulus, *question.poisson_ratio, question.dimension);
  }
  return stiffness.constants(moduli, c2);
}

/// "key": value, refused if there is no such number.
std::string pair(const char* key, double value) {
  if (std::isfinite(value)) return fmt::format("\"{}\": {:.12g}", key, value);
  throw InputError("", "",
                   std::string("the result has no finite ") + key +
                       ": give a lattice and a material whose constants and moduli are in the "
                       "range of double precision");
}

std::string section(const CpdConstants& constants, const CpdStiffness& stiffness) {
  const CubicElasticity elasticity = stiffness.elasticity(constants);
  const int dimension = stiffness.dimension;
  const LameModuli moduli = elasticity.isotropic(dimension);
  const std::vector<std::string> pairs{
      pair("c1", constants.c1),
      pair("c2", constants.c2),
      pair("c3", constants.c3),
      pair("lambda", moduli.lambda),
      pair("mu", moduli.mu),
      pair("youngs_modulus", youngs_modulus_of(moduli, dimension)),
      pair("poisson_ratio", poisson_ratio_of(moduli, dimension)),
      pair("anisotropy", elasticity.anisotropy()),
      pair("axis_poisson_ratio", elasticity.axis_poisson_ratio(dimension))};
  return fmt::format("{{{}}}", fmt::join(pairs, ", "));
}

/// Refuses a lattice on which the contribution of a unit constant underflows (with the ninth power
/// of a length in 3D) or overflows: its ratios would be arbitrary.
void require_representable(const CalibrationQuestion& question, const CpdStiffness& stiffness) {
  for (const CubicElasticity* part : {&stiffness.of_c1, &stiffness.of_c2, &stiffness.of_c3}) {
    const double lambda = part->isotropic(stiffness.dimension).lambda;
    if (lambda == 0.0 && part == &stiffness.of_c3 && stiffness.dimension == 2) continue;
    if (std::isnormal(lambda)) continue;
    throw InputError(
        "--spacing", number_text(question.spacing),
        "with horizon_ratio = " + number_text(question.horizon_ratio) +
            " and thickness = " + number_text(question.thickness) +
            " the stiffness of a point is out of the range of double precision; give lengths in m");
  }
}

void check_place(const CalibrationQuestion& where, const BondCalibrationQuestion& question) {
  const bool has_any_ratio = takes(question.material.model, Option::poisson_ratio);
  if (where.dimension < 1 || where.dimension > 3) {
    throw InputError("--dimension", std::to_string(where.dimension), "must be 1, 2 or 3");
  }
  require_positive("spacing", where.spacing);
  require_positive("thickness", where.thickness);
  require_positive("area", question.area);
  require_finite("angle", question.angle);
  const double largest = where.dimension == 3 ? 100.0 : 1000.0;
  if (!(where.horizon_ratio >= 1.0 && where.horizon_ratio <= largest)) {
    throw InputError("--horizon-ratio", number_text(where.horizon_ratio),
                     "must be between 1 and " + number_text(largest));
  }
  const auto refuse = [](const char* key, double value, const char* why) {
    throw InputError(option(key), number_text(value), why);
  };
  if (where.dimension != 2 && where.thickness != 1.0)
    refuse("thickness", where.thickness, "is for --dimension 2");
  if (where.dimension != 1 && question.area != 1.0)
    refuse("area", question.area, "is for --dimension 1");
  if (question.horizon_shape != HorizonShape::ball &&
      (where.dimension == 1 || question.volume_correction != VolumeCorrection::none)) {
    throw InputError("--horizon-shape", "",
                     "box and diamond are for --dimension 2 and 3 without a --volume-correction");
  }
  if (question.horizon_shape != HorizonShape::ball &&
      !takes(question.material.model, Option::horizon_shape)) {
    throw InputError("--horizon-shape", "", "is for --model bond");
  }
  if (where.poisson_ratio && !has_any_ratio) {
    refuse("poisson_ratio", *where.poisson_ratio, "is for --model cpd and state");
  }
  for (const auto& [key, value] :
       {std::pair("lambda", where.lambda), std::pair("mu", where.mu), std::pair("c1", where.c1),
        std::pair("c2", where.c2), std::pair("c3", where.c3)}) {
    if (value) refuse(key, *value, "is for --model cpd");
  }
}

/// Prints the calibration of the bonds or states of a case.
Exit calibrate_bonds(const Case& from, bool with_strengths, std::FILE* out) {
  const auto body = make_body(from, 1);
  located_errors(from, [&] {
    if (!body->points.horizons.empty())
      throw InputError("horizon_per_size", "",
                       "makes the constants differ from point to point; leave it out, or give one "
                       "horizon, a length");
    const PointMaterials materials(body->specification, body->points);
    const auto all = all_materials(body->specification, materials);
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all.size() > 1) fmt::print(out, "{}\"{}\":\n", k == 0 ? "{" : ", ", all[k].name);
      fmt::print(out, "{}",
                 bond_calibration(*all[k].of, all[k].key, body->setting, body->points.spacing,
                                  with_strengths));
    }
    if (all.size() > 1) fmt::print(out, "}}\n");
  });
  return Exit::done;
}

/// Replaces the key of a material's error by the option of the command line.
InputError of_options(const InputError& error) {
  if (error.key().starts_with("--")) return error;
  const std::string& key = error.key();
  const std::size_t dot = key.rfind('.');
  return {dot == std::string::npos ? "" : option(key.substr(dot + 1)), error.value(),
          error.allowed()};
}

/// @param damage JSON of the law of damage; empty: there is none
void print_calibration(std::FILE* out, const CalibrationQuestion& question,
                       const std::string& damage) {
  const int dimension = question.dimension;
  const double horizon = question.horizon_ratio * question.spacing;
  Kernel kernel{dimension, horizon, question.thickness};
  kernel.influence = influence_named(question.influence);
  const CpdStiffness lattice = lattice_stiffness(kernel, question.spacing);
  const CpdStiffness continuum = continuum_stiffness(dimension, horizon, question.thickness);
  for (const CpdStiffness* stiffness : {&lattice, &continuum}) {
    require_representable(question, *stiffness);
  }
  const bool has_continuum = !kernel.influence;
  CpdConstants on_lattice, in_continuum;
  try {
    on_lattice = constants_of(question, lattice);
    if (has_continuum) in_continuum = constants_of(question, continuum);
  } catch (const InputError& error) {
    throw InputError(option(error.key()), error.value(), error.allowed());
  }
  const BulkNeighbourhood bulk =
      bulk_neighbourhood(dimension, question.spacing, horizon, question.thickness);
  const auto ratio = [&](CubicElasticity CpdStiffness::*part) {
    const double of_lattice = (lattice.*part).isotropic(dimension).lambda;
    const double of_continuum = (continuum.*part).isotropic(dimension).lambda;
    return of_continuum == 0.0 || !has_continuum ? "null"
                                                 : fmt::format("{:.6g}", of_lattice / of_continuum);
  };
  fmt::print(
      out,
      "{{\n"
      "  \"dimension\": {}, \"spacing\": {:.12g}, \"horizon\": {:.12g}, \"thickness\": {:.12g},\n"
      "  \"neighbours\": {}, \"pairs\": {}, \"triplets\": {},\n"
      "  \"lattice\": {},\n"
      "  \"continuum\": {},\n"
      "  \"lattice_over_continuum\": {{\"c1\": {}, \"c2\": {}, \"c3\": {}}}{}\n"
      "}}\n",
      dimension, question.spacing, horizon, question.thickness, bulk.neighbours, bulk.pairs,
      bulk.triplets, section(on_lattice, lattice),
      has_continuum ? section(in_continuum, continuum) : "null", ratio(&CpdStiffness::of_c1),
      ratio(&CpdStiffness::of_c2), ratio(&CpdStiffness::of_c3),
      damage.empty() ? "" : ",\n  \"damage\": " + damage);
}

}  // namespace

Exit calibrate(const CalibrationQuestion& where, BondCalibrationQuestion question) {
  check_place(where, question);
  BondSetting setting;
  setting.dimension = where.dimension;
  setting.horizon = where.horizon_ratio * where.spacing;
  setting.cross_section = where.dimension == 1 ? question.area : where.thickness;
  setting.volume_correction = question.volume_correction;
  setting.shape = question.horizon_shape;
  setting.plane = question.material.plane;
  setting.influence = influence_named(question.material.influence);
  setting.lattice = {where.spacing, question.angle, question.surface_correction};
  question.material.youngs_modulus = where.youngs_modulus;
  question.material.poisson_ratio = where.poisson_ratio;
  try {
    check_material(question.material, "material", where.dimension);
    fmt::print("{}", bond_calibration(question.material, "material", setting, where.spacing,
                                      where.with_strengths));
  } catch (const InputError& error) {
    throw of_options(error);
  }
  return Exit::done;
}

Exit calibrate(const CalibrationQuestion& question, const DamageSpecification& damage) {
  check(question);
  const int dimension = question.dimension;
  BondSetting setting;
  setting.dimension = dimension;
  setting.horizon = question.horizon_ratio * question.spacing;
  setting.cross_section = question.thickness;
  setting.influence = influence_named(question.influence);
  MaterialSpecification material;
  material.model = MaterialModel::cpd;
  material.influence = question.influence;
  material.youngs_modulus = question.youngs_modulus;
  material.poisson_ratio = question.poisson_ratio;
  material.c1 = question.c1;
  material.c2 = question.c2.value_or(0.0);
  material.c3 = question.c3.value_or(0.0);
  material.damage = damage;
  std::string told;
  try {
    if (question.lambda) {
      const LameModuli moduli{*question.lambda, *question.mu};
      material.youngs_modulus = youngs_modulus_of(moduli, dimension);
      material.poisson_ratio = poisson_ratio_of(moduli, dimension);
    }
    check_material(material, "material", dimension);
    require_law(damage, question.with_strengths);
    if (damage.law != DamageLaw::none) {
      told = damage_calibration(material, "material", setting, question.spacing,
                                question.with_strengths);
    }
  } catch (const InputError& error) {
    throw of_options(error);
  }
  print_calibration(stdout, question, told);
  return Exit::done;
}

Exit calibrate(const Case& from, bool with_strengths, std::FILE* out) {
  if (takes(from, Option::micromodulus)) return calibrate_bonds(from, with_strengths, out);
  if (!takes(from, Option::constants)) {
    if (takes(from, Option::strength)) return calibrate_bonds(from, with_strengths, out);
    throw InputError("material.model", name_of(from.material.model),
                     "uses E and nu as they are given; calibrate " + is_for(Option::strength));
  }
  const Points points = make_points_of(from);
  located_errors(from, [&] { require_whole_square_cells(points); });
  CalibrationQuestion question;
  question.dimension = from.dimension;
  question.spacing = points.spacing;
  if (const auto* lattice = std::get_if<Lattice>(&from.body)) {
    question.horizon_ratio = from.horizon_ratio;
    if (from.dimension == 2) question.thickness = lattice->cross_section;
  } else {
    const auto& source = std::get<PointSource>(from.body);
    question.horizon_ratio = source.horizon.length / points.spacing;
    if (from.dimension == 2) question.thickness = source.cross_section;
  }
  BondSetting setting;
  setting.dimension = from.dimension;
  setting.horizon = question.horizon_ratio * points.spacing;
  setting.cross_section = question.thickness;
  question.influence = from.material.influence;
  setting.influence = influence_named(question.influence);
  const auto all =
      located_errors(from, [&] { return all_materials(from, PointMaterials(from, points)); });
  for (std::size_t k = 0; k < all.size(); ++k) {
    const MaterialSpecification& material = *all[k].of;
    question.youngs_modulus = material.youngs_modulus;
    question.poisson_ratio = material.poisson_ratio;
    question.c1 = material.c1;
    question.c2.reset();
    question.c3.reset();
    if (material.c1 || from.dimension == 3) question.c2 = material.c2;
    if (material.c1) question.c3 = material.c3;
    if (all.size() > 1) fmt::print(out, "{}\"{}\":\n", k == 0 ? "{" : ", ", all[k].name);
    check(question);
    require_law(material.damage, with_strengths);
    const std::string damage = located_errors(from, [&] {
      return material.damage.law == DamageLaw::none
                 ? ""
                 : damage_calibration(material, all[k].key, setting, points.spacing,
                                      with_strengths);
    });
    print_calibration(out, question, damage);
  }
  if (all.size() > 1) fmt::print(out, "}}\n");
  return Exit::done;
}

}  // namespace peristat
