#include "cases/runner/setup/part_body.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <variant>

#include "cases/runner/input/case_keys.hpp"
#include "cases/runner/setup/body.hpp"
#include "cases/runner/setup/find_boundary.hpp"
#include "solvers/formulations/faster_operator.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/observe/probe_places.hpp"
#include "solvers/ranks/distribute.hpp"
#include "solvers/ranks/part_bonds.hpp"
#include "src/conditions/pressed_boundary.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/image_kinds.hpp"
#include "src/geometry/point_file.hpp"
#include "src/geometry/point_set.hpp"
#include "src/geometry/slab.hpp"
#include "src/neighbourhood/ghost_sites.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// "load[2].body_force[0]" as "load.body_force".
std::string without_numbers(const std::string& key) {
  std::string plain;
  bool is_number = false;
  for (const char letter : key) {
    if (letter == '[') is_number = true;
    if (!is_number) plain += letter;
    if (letter == ']') is_number = false;
  }
  return plain;
}

/// True if a key runs on ranks, is below one that does, or is a table with one that does.
bool has_ranks(const std::string& key) {
  return std::ranges::any_of(keys_on_ranks(), [&](const std::string& known) {
    return key == known || key.starts_with(known + ".") || known.starts_with(key + ".");
  });
}

[[noreturn]] void refuse(const std::string& key, const std::string& value,
                         const std::string& instead) {
  throw InputError(key, value, "is not for more than one rank yet; " + instead);
}

/// Refuses convolutions: their transforms need the whole body, which no rank has.
void refuse_convolutions(const Case& from) {
  const std::string why = "is for one rank, because convolutions need the whole body; ";
  if (needs_convolutions(from)) {
    const bool is_by_form = from.form == SolidForm::printed;
    throw InputError(is_by_form ? "quadrature.form" : "material.model", "",
                     why + "models with bonds run on several");
  }
  if (from.solver.force_operator == ForceOperator::stencil) {
    throw InputError("solver.operator", "\"stencil\"",
                     "is for one rank; \"bonds\" sums along rows on several, too");
  }
  if (from.solver.force_operator != ForceOperator::fft) return;
  throw InputError("solver.operator", "\"fft\"",
                   why + "on several ranks take \"bonds\" or \"auto\"");
}

/// Refuses values that run on one rank only, for keys with other values that run on several.
void refuse_values_without_ranks(const Case& from) {
  if (!from.givens->none()) {
    throw InputError("", "",
                     "functions and points that a program gives are for one rank: write the points "
                     "to a file, and the functions as expressions or tables");
  }
  refuse_convolutions(from);
  const bool is_lattice = std::holds_alternative<Lattice>(from.body);
  if (const auto* const source = std::get_if<PointSource>(&from.body);
      source != nullptr && source->is_mesh())
    refuse("points.file", source->file.string(),
           "`peristat points` writes the points of a mesh to a file that runs on several ranks, "
           "without the cuts by its boundary");
  const bool has_shares = from.volume_correction != VolumeCorrection::none &&
                          from.volume_correction != VolumeCorrection::linear;
  if (formulation_of(from).part_needs_lattice && (!is_lattice || has_shares)) {
    refuse(
        "material.model", "",
        "models other than \"bond\" need a lattice, and volume_correction \"none\" or \"linear\"");
  }
  const Mode mode = from.solver.mode;
  if (mode == Mode::path || mode == Mode::arc_length || mode == Mode::fatigue) {
    refuse("solver.mode", std::string(mode.name),
           "take \"newton\", \"adaptive\", \"relaxation\" or \"dynamics\"");
  }
}

/// Adds the sets. Rules depend on positions only, so that each rank finds its own members.
/// Collective.
void add_sets(const Case& from, const Communicator& ranks, Part& part) {
  for (std::size_t k = 0; k < from.sets.size(); ++k) {
    const SetRule& rule = from.sets[k];
    const std::string table = "set[" + std::to_string(k) + "]";
    if (part.points.sets.contains(rule.name)) {
      throw InputError(table + ".name", '"' + rule.name + '"',
                       "there is already a set of this name (sets and layers share their names)");
    }
    std::vector<Index> members;
    try {
      members = select(part.points, rule);
    } catch (const InputError& error) {
      throw InputError(table + "." + error.key(), error.value(), error.allowed());
    }
    const auto ghosts = std::lower_bound(members.begin(), members.end(), part.owned);
    if (ranks.count_all(ghosts - members.begin()).all == 0) {
      throw InputError(table, '"' + rule.name + '"', "the set selects no point");
    }
    part.points.sets[rule.name] = std::move(members);
  }
}

/// Makes this rank's slab of the points of a lattice or a file. Collective.
Part make_slab_of(const Case& from, const Communicator& ranks) {
  const auto* const lattice = std::get_if<Lattice>(&from.body);
  if (lattice == nullptr) {
    const auto& source = std::get<PointSource>(from.body);
    return read_slab(source.file, from.dimension, source.cross_section, ranks, source.length_unit);
  }
  Part slab = make_slab(*lattice, ranks);
  if (slab.points.lattice && lattice->perturbation == 0.0 && lattice->cell_perturbation == 0.0) {
    const auto& periods = from.constraints.periods;
    require_lattice_goes_on(slab.points, from.constraints.symmetries,
                            {periods.begin(), periods.end()}, ranks);
  }
  return slab;
}

}  // namespace

void refuse_keys_without_ranks(const Case& from) {
  located_errors(from, [&] {
    for (const auto& [key, location] : from.locations) {
      if (has_ranks(without_numbers(key))) continue;
      refuse(key, "", "docs/cluster.md lists the keys that are supported");
    }
    refuse_values_without_ranks(from);
  });
}

std::unique_ptr<const Body> make_part_body(const Case& from, const Communicator& ranks,
                                           int threads) {
  return located_errors(from, [&] {
    Part slab = make_slab_of(from, ranks);
    if (slab.whole > std::numeric_limits<Index>::max()) {
      refuse("lattice.spacing", "", "results have numbers for fewer than 2^31 points");
    }
    BodySpecification of = specification_of(from);
    take_horizons(slab.points, of, ranks);
    slab.points.horizons.clear();  // the parts' points get theirs again, with those of ghosts
    const BondSetting setting = bond_setting(of, slab.points);
    double reach = reach_of_bonds(slab.points, from.surface_correction, setting, ranks,
                                  formulation_of(from).part_bonds);
    const auto* const lattice = std::get_if<Lattice>(&from.body);
    const bool has_ghost_sites = lattice != nullptr && formulation_of(from).has_ghost_sites;
    if (has_ghost_sites) reach += ranks.max(reach_beyond_balls(*lattice, slab.points));
    if (from.has_pressures()) reach = std::max(reach, reach_of_pressures(slab.points));
    for (const ContactSpecification& contact : of.contacts) {
      reach = std::max(reach, contact.reach);
    }
    std::vector<ImageKind> images = kinds_of_images(of, slab.points, ranks);
    Part part =
        distribute(std::move(slab), setting.horizon, reach, ranks, threads, std::move(images));
    add_sets(from, ranks, part);
    if (has_ghost_sites) {
      // Ghost sites around neighbours of ghosts are wrong, but never used.
      part.points.ghosts = ghost_sites(*lattice, part.points, from.horizon).reference;
    }
    find_boundary(from, part.points, ranks, of);
    if (tells_stress(from)) of.evaluation_bytes_per_point = stress_bytes_per_point(from.dimension);
    std::unique_ptr<const Body> body = make_body(std::move(part), of, ranks, threads);
    require_places_of_probes(from.probes, {body->points, *body->index_map});
    return body;
  });
}

}  // namespace peristat
