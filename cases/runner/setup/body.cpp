#include "cases/runner/setup/body.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "cases/runner/setup/find_boundary.hpp"
#include "cases/runner/setup/read_mesh.hpp"
#include "solvers/body/body_memory.hpp"
#include "solvers/formulations/check_specification.hpp"
#include "solvers/formulations/faster_operator.hpp"
#include "solvers/formulations/materials/bond_materials.hpp"
#include "solvers/linear/available_memory.hpp"
#include "solvers/observe/probe_places.hpp"
#include "solvers/ranks/agree_on_kinds.hpp"
#include "src/connectivity/free_motion.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/given_points.hpp"
#include "src/geometry/point_file.hpp"
#include "src/neighbourhood/ghost_sites.hpp"

namespace peristat {

double stress_bytes_per_point(int dimension) {
  const double d = dimension;
  return sizeof(double) * (8.0 * d * d + d * (d + 1.0) + d + 2.0);
}

namespace {

/// Calls `make`; puts the name of a table in front of the keys of its input errors.
template <class Make>
auto errors_in_table(const std::string& table, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(table + (error.key().empty() ? "" : ".") + error.key(), error.value(),
                     error.allowed());
  }
}

/// Memory per point of the bodies beside one that is differentiated (Sensitivities), two for each
/// number: bonds, their histories and a copy of these, vectors, and the workspace of sums [byte].
double sensitivity_bytes_per_point(const Case& from) {
  const bool has_damage = from.material.damage.law != DamageLaw::none;
  const double per_bond = has_damage ? 22.0 : 6.0, d = from.dimension;
  const double bonds = bonds_per_point(from.dimension, from.horizon_ratio);
  return 2.0 * double(from.sensitivity.over.size()) *
         (per_bond * bonds + 8.0 * (6.0 * d + (from.dimension == 3 ? 18.0 : 12.0)));
}

const Lattice* lattice_of(const Case& from) { return std::get_if<Lattice>(&from.body); }

/// Refuses a lattice that can't fit before any of its points is made.
void require_memory_for_lattice(const Case& from, const Lattice& lattice) {
  const double points = estimate_points(lattice);
  BodySize size;
  size.dimension = from.dimension;
  size.points = points;
  size.longest = std::pow(points, 1.0 / from.dimension);
  size.horizon_ratio =
      reach_ratio(from.volume_correction, from.horizon_shape, from.dimension, from.horizon_ratio);
  constexpr double ratio_of_network = 1.5;
  const ForceOperator sums = from.solver.force_operator;
  const bool may_be_convolved = sums == ForceOperator::automatic || sums == ForceOperator::fft;
  if (may_be_convolved) size.horizon_ratio = ratio_of_network;
  size.bonds = expected_bonds(points, from.dimension, size.horizon_ratio);
  size.free_dofs = points * from.dimension;
  const Box box = lattice.shapes.empty() ? Box{} : bounds(lattice.shapes.front().shape);
  for (int c = 0; c < from.dimension; ++c) {
    const double along = (box.max[c] - box.min[c]) / lattice.spacing.along(c);
    if (std::isfinite(along)) size.longest = std::max(size.longest, along);
  }
  // This estimate counts the bounding box: only a lattice that cannot fit even if half of it is cut
  // away is refused here. The points themselves are checked later.
  require_memory(0.5 * estimate_memory(size).least_bytes(),
                 fmt::format("the case with up to {:.3g} points", points));
}

}  // namespace

Points make_points_of(const Case& from) {
  return located_errors(from, [&] {
    Points points;
    if (const Lattice* lattice = lattice_of(from)) {
      check_lattice(*lattice);  // first: the size of an invalid lattice is undefined
      require_memory_for_lattice(from, *lattice);
      points = make_points(*lattice);
      if (points.lattice && formulation_of(from).has_ghost_sites) {
        points.ghosts = ghost_sites(*lattice, points, from.horizon).reference;
      }
      if (points.lattice && lattice->perturbation == 0.0 && lattice->cell_perturbation == 0.0) {
        const auto& periods = from.constraints.periods;
        require_lattice_goes_on(points, from.constraints.symmetries,
                                {periods.begin(), periods.end()});
      }
    } else {
      const auto& source = std::get<PointSource>(from.body);
      std::optional<NeighbourFile> neighbours;
      if (!source.neighbours.empty())
        neighbours = {source.neighbours, source.horizon.length, source.cross_section};
      points = from.givens->points
                   ? points_of_given(*from.givens->points, source.cross_section, source.length_unit)
               : source.is_mesh() ? read_mesh_points(source, from.dimension)
                                  : read_points(source.file, from.dimension, source.cross_section,
                                                neighbours, source.length_unit);
    }
    points.functions = given_functions(from);
    for (std::size_t k = 0; k < from.sets.size(); ++k) {
      const SetRule& rule = from.sets[k];
      const std::string table = "set[" + std::to_string(k) + "]";
      errors_in_table(table, [&] { add_set(points, rule); });
    }
    require_places_of_probes(from.probes, RecordedPoints(points));
    return points;
  });
}

std::vector<Crack> cracks_of_shapes(const Case& from) {
  std::vector<Crack> cracks;
  const Lattice* const lattice = lattice_of(from);
  if (lattice == nullptr) return cracks;
  for (const ShapeStep& step : lattice->shapes) {
    if (step.cuts_bonds) cracks.emplace_back(CrackShape{step.shape, lattice->dimension});
  }
  return cracks;
}

BodySpecification specification_of(const Case& from) {
  BodySpecification of = from;
  for (Crack& crack : cracks_of_shapes(from)) of.cracks.push_back(std::move(crack));
  return of;
}

std::unique_ptr<const Body> make_body(const Case& from, int threads) {
  Points points = make_points_of(from);
  BodySpecification of = specification_of(from);
  of.force_operator = from.solver.force_operator;
  located_errors(from, [&] { find_boundary(from, points, SoleRank(), of); });
  if (of.force_operator == ForceOperator::automatic) {
    of.force_operator = faster_operator(
        of, points,
        from.solver.mode == Mode::dynamics && from.dynamics.scheme == MotionScheme::verlet);
  }
  if (from.solver.mode == Mode::path) of.teeth = from.loading.teeth;
  if (tells_stress(from)) {
    of.evaluation_bytes_per_point = stress_bytes_per_point(from.dimension);
    // Convolved models store no bonds: they are found for the stress.
    constexpr double bytes_per_bond = 6.0;
    if (of.is_convolved()) {
      of.evaluation_bytes_per_point +=
          bytes_per_bond * bonds_per_point(from.dimension, from.horizon_ratio);
    }
  }
  of.evaluation_bytes_per_point += sensitivity_bytes_per_point(from);
  return located_errors(from, [&] { return make_body(std::move(points), of, threads); });
}

std::optional<Model> make_elastic_stand_in(const Case& from, const Body& body, int threads) {
  if (from.solver.elastic_horizon_ratio == 0.0 || from.solver.mode != Mode::adaptive) return {};
  return located_errors(from, [&]() -> std::optional<Model> {
    const std::string key = "solver.elastic_horizon_ratio";
    const auto has_modulus = [](const auto& material) {
      return material.of->youngs_modulus.has_value();
    };
    const PointMaterials materials(from, body.points);
    const auto all = all_materials(from, materials);
    if (!formulation_of(from).has_elastic_stand_in || !std::ranges::all_of(all, has_modulus))
      throw InputError(key, number_text(from.solver.elastic_horizon_ratio),
                       "needs the bond model with a youngs_modulus: a micromodulus is valid for "
                       "one horizon only");
    require_summable(from.material, from.dimension, key,
                     number_text(from.solver.elastic_horizon_ratio),
                     from.solver.elastic_horizon_ratio);
    if (!body.points.neighbours.empty())
      throw InputError(key, number_text(from.solver.elastic_horizon_ratio),
                       "is for neighbours found by the search, but points.neighbours gives them");
    if (from.solver.elastic_horizon_ratio * body.points.spacing < body.points.spacing.largest())
      throw InputError(key, number_text(from.solver.elastic_horizon_ratio),
                       "gives a horizon smaller than the largest spacing");
    if (body.points.own() < body.points.count() &&
        from.solver.elastic_horizon_ratio > from.horizon_ratio) {
      throw InputError(key, number_text(from.solver.elastic_horizon_ratio),
                       "must not exceed horizon_ratio with planes of symmetry or periods: the body "
                       "has images only up to that distance");
    }
    if (!body.index_map->is_whole() && from.solver.elastic_horizon_ratio > from.horizon_ratio) {
      throw InputError(key, number_text(from.solver.elastic_horizon_ratio),
                       "must not exceed horizon_ratio on more than one rank: there are ghosts only "
                       "up to that distance");
    }
    BondSetting setting = body.setting;
    setting.horizon = from.solver.elastic_horizon_ratio * body.points.spacing;
    Bonds bonds = make_bonds(body.points, from.surface_correction, setting, threads);
    if (!body.index_map->is_whole()) {
      bonds.remove_if([&](Index i, Offset bond) {  // between ghosts
        return !body.points.owns(i) && !body.points.owns(bonds.partner(i, bond));
      });
      agree_on_kinds(bonds, body.points, body.index_map->numbered(), body.index_map->ranks());
    }
    static_cast<void>(cut_bonds(bonds, body.points, body.specification.cracks));
    const Holding holding =
        body.conditions->holding(std::vector<double>(body.conditions->constraints().dofs(), 0.0));
    if (!free_motions(body.points, bonds, holding, *body.index_map).empty())
      throw InputError(key, number_text(from.solver.elastic_horizon_ratio),
                       "leaves points that may move freely");
    Model stand_in = make_elastic_bonds(body, std::move(bonds), setting);
    add_terms_of_conditions(stand_in, body);
    return stand_in;
  });
}

}  // namespace peristat
