#include "cases/runner/setup/preflight_rules.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "src/geometry/local_spacing.hpp"

namespace peristat {
namespace {

using Kind = FeatureLength::Kind;
using Warnings = std::vector<std::string>;

/// Largest difference between a box and whole cells, in spacings: the round-off of decimals.
constexpr double round_off = 1e-6;

void add_divisions(const Preflight& of, Warnings& warnings) {
  for (const auto& [key, axis, asked, made, cells] : of.divisions) {
    if (std::abs(made - asked) <= round_off * made / cells) continue;
    warnings.push_back(fmt::format(
        "the spacing does not divide {} along {}: {:g} m become {:.0f} spacings, {:g} m; a spacing "
        "of {:.6g} m would fit, or lattice.volumes = \"fractional\", which cuts cells",
        key, "xyz"[axis], asked, cells, made, asked / cells));
  }
}

void add_cross_section(const Preflight& of, Warnings& warnings) {
  if (!of.cross_section_counts) return;
  const char* const what = of.dimension == 1 ? "area" : "thickness";
  if (!of.cross_section_is_given) {
    warnings.push_back(
        fmt::format("{} is not given, so it is 1 {}: all forces and energies are those of a body "
                    "that {}; give the {}, or give 1 if that is intended",
                    of.cross_section_key, of.dimension == 1 ? "m2" : "m",
                    of.dimension == 1 ? "has this area" : "is a metre thick", what));
    return;
  }
  // A thickness of exactly 1 m is intended, for forces per metre.
  const double largest = *std::max_element(of.extents.begin(), of.extents.end());
  if (of.dimension == 2 && of.cross_section != 1.0 && of.cross_section > largest) {
    warnings.push_back(
        fmt::format("{} = {:g} m is more than the length of the body ({:g} m), so the body is not "
                    "a plate in plane stress; check that lengths are in metres",
                    of.cross_section_key, of.cross_section, largest));
  }
}

void add_horizon(const Preflight& of, Warnings& warnings) {
  for (const Kind kind : {Kind::body, Kind::ligament}) {
    const FeatureLength* const least = of.shortest(kind);
    if (least == nullptr || of.horizon <= least->size) continue;
    warnings.push_back(fmt::format(
        "the horizon, {:g} m, is larger than the {}, {:g} m: a surface cuts the neighbourhood of "
        "every point there; with a spacing of {:.2g} m or less it is three horizons wide",
        of.horizon, least->what, least->size, least->size * of.spacing / (3.0 * of.horizon)));
  }
}

void add_grading(const Preflight& of, Warnings& warnings) {
  if (!of.mesh || of.mesh->has_horizons) return;
  if (of.mesh->coarsest_spacing <= graded_ratio * of.mesh->finest_spacing) return;
  warnings.push_back(fmt::format(
      "the mesh is graded: around a point its spacing is {:.3g} to {:.3g} m, a ratio above {}, so "
      "that the horizon, {:g} m, is {:.3g} spacings where it is coarsest and {:.3g} where it is "
      "finest; a horizon below 3 spacings resolves neither stiffness nor cracks. "
      "points.horizon = {{ ratio = 3.015 }} gives each point a horizon of its own",
      of.mesh->finest_spacing, of.mesh->coarsest_spacing, graded_ratio, of.horizon,
      of.horizon / of.mesh->coarsest_spacing, of.horizon / of.mesh->finest_spacing));
}

void add_bridged(const Preflight& of, Warnings& warnings) {
  for (const Preflight::Opening& opening : of.openings) {
    if (opening.bridging == 0) continue;
    warnings.push_back(fmt::format(
        "{} bonds bridge {} ({}, {:g} m wide, narrower than the horizon, {:g} m) and hold its "
        "sides together; cuts_bonds = true in its table cuts them",
        opening.bridging, opening.key, opening.kind, opening.width, of.horizon));
  }
}

void add_constant_values(const Preflight& of, Warnings& warnings) {
  const bool is_path = of.may_fail || of.steps > 1;  // one elastic step may have constant values
  if (!of.is_quasi_static || !is_path) return;
  const bool grows = of.is_controlled || std::ranges::any_of(of.applied, [](const auto& value) {
                       return value.changes && value.largest > 0.0;
                     });
  for (const Preflight::Applied& value : of.applied) {
    const bool is_displacement = value.kind == GivenValue::Kind::displacement;
    if (value.changes || value.largest == 0.0) continue;
    if (grows && !is_displacement) continue;  // a dead load under one that grows
    warnings.push_back(
        fmt::format("{} = {} does not depend on load: it is applied in full at load 0 and stays "
                    "constant; write \"{}*load\" if it should grow with the load",
                    value.key, value.text, value.text));
  }
}

void add_nothing_applied(const Preflight& of, Warnings& warnings) {
  const bool is_any =
      of.is_controlled || of.begins_moving || of.has_functions ||
      std::ranges::any_of(of.applied, [](const auto& value) { return value.largest > 0.0; });
  if (is_any) return;
  warnings.emplace_back(
      "nothing is applied: every prescribed displacement and load is always 0, so nothing moves; "
      "give a [[support]] a displacement, or add a [[load]]");
}

void add_stiffnesses(const Preflight& of, Warnings& warnings) {
  constexpr double softest_gel = 1e3;   // [Pa]
  constexpr double no_dimension = 2.5;  // moduli of problems without units are about 1
  for (const auto& [key, modulus] : of.stiffnesses) {
    if (modulus <= no_dimension || modulus >= softest_gel) continue;
    warnings.push_back(fmt::format(
        "{} = {:g} Pa is softer than any solid; check its unit: numbers without a unit are in SI "
        "units, or in those of [units]; {:g} GPa is {:g}e9, {:g} MPa is {:g}e6 in Pa",
        key, modulus, modulus, modulus, modulus, modulus));
  }
}

void add_fracture(const Preflight& of, const Preflight::Fracture& fracture, Warnings& warnings) {
  const std::string name = fracture.name.empty() ? "" : " of " + fracture.name;
  constexpr double too_stretched = 0.5;
  const bool is_soft = std::ranges::any_of(of.stiffnesses, [&](const auto& stiffness) {
    return stiffness.youngs_modulus >= 1e3 && stiffness.youngs_modulus < 1e6;
  });
  if (is_soft && fracture.critical > too_stretched) {
    warnings.push_back(
        fmt::format("bonds{} break only at a stretch of {:.3g}, which is large for a solid; check "
                    "the units: youngs_modulus and strength are in Pa (30 GPa and 30000 MPa are "
                    "30e9), fracture_energy is in J/m2",
                    name, fracture.critical));
  }
  if (!fracture.softens) return;
  // docs/trustworthy-peaks.md: the default law has a length of 2.4 horizons. With bonds 1.6 times
  // as strong, cracks run at up to 1.03 of the toughness, with brittle bonds at up to 1.19.
  constexpr double shortest_zone = 1.1;  // in horizons
  const double zone = fracture.characteristic_length();
  // Stretches that a case gives are a modelling choice: their strength is no datum to be met.
  if (fracture.is_data && zone < shortest_zone * of.horizon) {
    warnings.push_back(
        fmt::format("the spacing is coarse for the process zone{}: E G/ft^2 = {:.3g} m is {:.2g} "
                    "horizons, and below {:g} horizons the lattice traps a crack as it does with "
                    "brittle bonds; a spacing of {:.2g} m or less resolves the zone",
                    name, zone, zone / of.horizon, shortest_zone,
                    of.spacing * zone / (shortest_zone * of.horizon)));
  }
  if (!fracture.has_strength && !of.has_notch) {
    warnings.push_back(fmt::format(
        "{}.damage.strength is missing, and there is no crack, notch or hole from which a crack "
        "could start: the strength of {:.4g} MPa follows from the horizon, and the peak grows with "
        "each refinement; give the strength of the material",
        fracture.key, fracture.strength * 1e-6));
  }
}

void add_idle(const Preflight& of, Warnings& warnings) {
  for (const auto& [key, needs] : of.idle) {
    warnings.push_back(fmt::format("{} is not used: it needs {}", key, needs));
  }
}

}  // namespace

std::vector<std::string> warnings_of(const Preflight& of) {
  Warnings warnings;
  for (const auto& rule : {add_divisions, add_cross_section, add_horizon, add_grading, add_bridged,
                           add_constant_values, add_nothing_applied, add_stiffnesses}) {
    rule(of, warnings);
  }
  for (const Preflight::Fracture& fracture : of.fractures) add_fracture(of, fracture, warnings);
  warnings.insert(warnings.end(), of.of_materials.begin(), of.of_materials.end());
  add_idle(of, warnings);
  return warnings;
}

}  // namespace peristat
