#include "solvers/body/body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <omp.h>

#include "assembly/terms/bonds/bond_term.hpp"
#include "assembly/terms/contact/obstacle_term.hpp"
#include "assembly/terms/linear/linear_term.hpp"
#include "assembly/terms/pressure/pressure_term.hpp"
#include "assembly/terms/springs/foundation_term.hpp"
#include "assembly/terms/springs/inertia_term.hpp"
#include "assembly/terms/states/state_term.hpp"
#include "solvers/body/body_memory.hpp"
#include "solvers/body/point_contacts.hpp"
#include "solvers/body/require_memory_for.hpp"
#include "solvers/body/surface_sites.hpp"
#include "solvers/body/youngs_moduli.hpp"
#include "solvers/formulations/check_specification.hpp"
#include "solvers/formulations/convolved/convolved_lattice.hpp"
#include "solvers/formulations/specification/for_each_material.hpp"
#include "solvers/linear/available_memory.hpp"
#include "solvers/ranks/sum_on_machine.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/core/stopwatch.hpp"
#include "src/core/threads.hpp"
#include "src/geometry/image_kinds.hpp"
#include "src/geometry/point_sizes.hpp"
#include "src/neighbourhood/bond_runs.hpp"
#include "src/neighbourhood/horizon.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Refuses points so far from the origin that round-off blurs the horizon.
void require_resolved(const Points& points, double horizon) {
  for (const double of_point : points.horizons) horizon = std::min(horizon, of_point);
  double farthest = 0.0;
  for (const double at : points.reference) farthest = std::max(farthest, std::abs(at));
  if (farthest * std::numeric_limits<double>::epsilon() <= horizon_tolerance * horizon) return;
  throw InputError("points.reference", "",
                   "a point is at " + number_text(farthest) +
                       " m, so far from the origin that round-off of its position is more than " +
                       number_text(horizon_tolerance) + " of the horizon, " + number_text(horizon) +
                       " m; move the body to the origin");
}

/// Refuses two points at one place: their bond has no length.
void refuse_coincident_points(const Points& points, const Bonds& bonds) {
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (std::isfinite(bonds.inverse_length(bond))) continue;
      throw InputError("points.reference", "",
                       "two points have the same position, " +
                           place_text(points.position(i), points.dimension) + " m");
    }
  }
}

/// Stores regions and random factors of the points.
void note_materials(Body& body, const PointMaterials& materials, int threads) {
  using Quantity = ScatterSpecification::Quantity;
  body.region = materials.regions();
  body.factors = {materials.factors(body.points, Quantity::stiffness, threads),
                  materials.factors(body.points, Quantity::strength, threads)};
}

/// Setting with which the bonds of a body are made.
BondSetting setting_of_bonds(const Body& body) {
  const BodySpecification& of = body.specification;
  BondSetting setting = setting_of_bonds(formulation_of(of), body.setting);
  return of.is_convolved() ? setting_of_short_bonds(body.points, std::move(setting)) : setting;
}

bool cuts_struts(const BodySpecification& of) {
  bool cuts = false;
  for_each_material(of, [&](const MaterialSpecification& material, const std::string&) {
    cuts |= material.damage.struts == StrutRemedy::cut;
  });
  return cuts;
}

/// @throws InputError unless most bonds are summed along rows of points
void require_rows(const Body& body, int threads) {
  const auto refuse = [](const std::string& why) {
    throw InputError("force_operator", "\"stencil\"", why + "; take \"bonds\"");
  };
  const Model& model = body.model;
  if (!model.find<BondTerm>() && !model.find<StateTerm>() && !model.find<LinearTerm>()) {
    refuse("is for bonds and states");
  }
  const double share = share_in_runs(body.points, body.model.bonds(), threads);
  if (share >= BondRuns::least_share) return;
  refuse("is for rows of lattice points; of this body's bonds only " +
         std::to_string(std::lround(100.0 * share)) + " % are in such rows");
}

/// Makes the model of a body, and stores the bonds that its pre-cracks have cut.
/// @param make_network makes the bonds of a setting
template <class MakeNetwork>
void make_model(Body& body, const MakeNetwork& make_network, int threads) {
  const BodySpecification& of = body.specification;
  const Stopwatch watch(body.seconds_neighbourhood);
  Bonds bonds = make_network(setting_of_bonds(body));
  refuse_coincident_points(body.points, bonds);
  const PointMaterials materials(of, body.points);
  note_materials(body, materials, threads);
  MadeModel made = formulation_of(of).make_model(
      {of, materials, body.factors, body.points, body.setting, *body.index_map, threads},
      std::move(bonds));
  body.model = std::move(made.model);
  if (cuts_struts(of)) {
    body.model.cut_struts(std::make_shared<const Struts>(body.points, body.model.bonds()));
  }
  if (of.force_operator == ForceOperator::stencil) require_rows(body, threads);
  body.cut_weight = std::move(made.cut.weight);
  body.cut_bonds = std::move(made.cut.ends);
  body.remarks = std::move(made.remarks);
}

/// Stores interactions that can be stored if they fit into half of the memory that everything else
/// leaves: on a machine those of all its ranks, or none.
void store_interactions(Body& body, int threads) {
  InteractionStorage& storage = body.interaction_storage;
  for (const auto& term : body.model.terms()) storage.needed += term->bytes_to_store();
  // A rank may have no points; there is no estimate for this case.
  double others = body.points.count() == 0 ? 0.0 : estimate_memory(body).least_bytes();
  storage.needed = sum_on_machine(body.index_map->ranks(), storage.needed);
  others = sum_on_machine(body.index_map->ranks(), others);
  storage.room = std::max(0.5 * (available_memory() - others), 0.0);
  if (!storage.fits()) return;
  for (const auto& term : body.model.terms()) term->store(body.points, threads);
}

/// Distance up to which images are needed [m]: a partial volume reaches half a cell's diagonal
/// beyond the horizon, in a cloud half the size of its largest point. Contacts may reach farther.
/// Collective.
double reach_of_images(const BodySpecification& of, const Points& points,
                       const Communicator& ranks) {
  double beyond = 0.0;
  if (of.volume_correction != VolumeCorrection::none) {
    const double cross_section = cross_section_of(of, points);
    for (Index i = 0; i < points.count(); ++i) {
      beyond = std::max(beyond, 0.5 * size_of_point(points, i, cross_section));
    }
    beyond = std::max(ranks.max(beyond), points.spacing.largest());
  }
  double reach = of.horizon * farthest_of(of.horizon_shape, points.dimension) + beyond;
  for (const ContactSpecification& contact : of.contacts) reach = std::max(reach, contact.reach);
  return reach;
}

/// A quantity of the points' materials; empty if no material has it.
/// @param needed feature that needs it; empty: none does
/// @throws InputError if some materials have it and others not, and it is needed
std::vector<double> of_materials(const PointMaterials& materials, const Points& points,
                                 std::optional<double> MaterialSpecification::*quantity,
                                 const std::string& key, const std::string& needed) {
  const auto has = [&](const auto& material) { return (material.of->*quantity).has_value(); };
  const auto& all = materials.all();
  if (std::none_of(all.begin(), all.end(), has)) return {};
  const auto lacks = std::find_if_not(all.begin(), all.end(), has);
  if (lacks != all.end()) {
    if (needed.empty()) return {};
    throw InputError(lacks->key + "." + key, "", "is missing; " + needed + " needs it");
  }
  std::vector<double> values;
  for (Index i = 0; i < points.count(); ++i) {
    values.push_back(*(all[materials.of(i)].of->*quantity));
  }
  return values;
}

/// Finds the surface sites on which tractions of a body by collocation act.
void take_surface(Body& body, LoadSetting& loads, int threads) {
  const BodySpecification& of = body.specification;
  if (!takes(of, Option::surface_loads)) return;
  loads.surface = surface_sites(body.points, body.model, of.boundary.get(), of.boundary_names,
                                body.setting.horizon, threads);
  body.specification.boundary.reset();
}

LoadingProgramme programme_of(const BodySpecification& of) {
  if (of.end_time) return LoadingProgramme::of_time(*of.end_time, of.loads_over_time);
  return of.programme.empty() ? LoadingProgramme() : LoadingProgramme(of.programme);
}

LoadSetting load_setting(const Body& body, const BodySpecification& of) {
  const Points& points = body.points;
  const PointMaterials materials(of, points);
  const bool has_gravity = std::any_of(
      of.loads.begin(), of.loads.end(),
      [](const LoadSpecification& load) { return load.kind == LoadSpecification::Kind::gravity; });
  LoadSetting setting{.horizon = of.horizon, .index_map = *body.index_map};
  if (!of.obstacles.empty()) {
    setting.of_obstacles = {body.setting.cross_section, youngs_moduli(body)};
  }
  setting.density = of_materials(materials, points, &MaterialSpecification::density, "density",
                                 has_gravity ? "gravity" : "");
  setting.thermal_expansion =
      of_materials(materials, points, &MaterialSpecification::thermal_expansion,
                   "thermal_expansion", of.eigenstrains.temperature_change ? "a temperature" : "");
  return setting;
}

}  // namespace

double Body::horizon_ratio() const {
  return points.horizons.empty() ? setting.horizon / points.spacing
                                 : mean_horizon_ratio(points, setting.cross_section);
}

void take_horizons(Points& points, BodySpecification& of, const Communicator& ranks) {
  if (of.horizon_per_size == 0.0) return;
  points.horizons = horizons_of_sizes(points, of.horizon_per_size, cross_section_of(of, points));
  of.horizon = ranks.max(largest_horizon(points));
}

std::vector<ImageKind> kinds_of_images(const BodySpecification& of, const Points& points,
                                       const Communicator& ranks) {
  const std::vector<Period> periods(of.constraints.periods.begin(), of.constraints.periods.end());
  return image_kinds(points, extent_of(points, ranks), of.constraints.symmetries, periods,
                     reach_of_images(of, points, ranks));
}

BondSetting bond_setting(const BodySpecification& of, const Points& points) {
  BondSetting setting;
  setting.dimension = points.dimension;
  setting.plane = of.material.plane;
  setting.volume_correction = of.volume_correction;
  setting.shape = of.horizon_shape;
  setting.influence = influence_named(of.material.influence);
  setting.horizon = of.horizon;
  setting.cross_section = cross_section_of(of, points);
  if (points.lattice) {
    setting.lattice = {points.spacing, points.angle, of.surface_correction};
  } else {
    const double size = points.horizons.empty()
                            ? double(points.spacing)
                            : of.horizon / mean_horizon_ratio(points, setting.cross_section);
    setting.cloud = {size, of.surface_correction};
  }
  return setting;
}

Model make_elastic_bonds(const Body& body, Bonds bonds, const BondSetting& setting) {
  BodySpecification elastic = body.specification;
  const auto spare = [](MaterialSpecification& material) { material.damage = {}; };
  spare(elastic.material);
  for (RegionSpecification& region : elastic.regions) spare(region.material);
  for (InterfaceSpecification& interface : elastic.interfaces) {
    if (interface.material) spare(*interface.material);
  }
  const PointMaterials materials(elastic, body.points);
  const BondMaterials mixed(elastic, materials, body.factors, body.points,
                            micromoduli(elastic, materials, setting));
  if (!elastic.is_uniform()) mixed.weigh(bonds);
  auto [potential, never_fails] = mixed.potential(bonds);
  return Model(std::move(bonds), std::move(potential));
}

int usable_threads(int asked_for) {
  if (asked_for < 0) {
    throw InputError("threads", std::to_string(asked_for), "must be at least 1, or 0 for all");
  }
  const int threads = asked_for == 0 ? omp_get_max_threads() : asked_for;
  run_on_threads(threads, [](int) {});
  return threads;
}

namespace {

/// Stores points and specification, before any bond is made.
void begin_body(Body& body, Points points, const BodySpecification& of) {
  body.points = std::move(points);
  body.setting = bond_setting(of, body.points);
  double fineness = 1.0;
  for (const double horizon : body.points.horizons) {
    fineness = std::max(fineness, body.setting.horizon / horizon);
  }
  body.specification =
      with_stretches(of, body.setting,
                     body.points.horizons.empty() ? double(body.points.spacing)
                                                  : body.setting.horizon / body.horizon_ratio(),
                     fineness);
  require_resolved(body.points, body.setting.horizon);
}

/// Makes model and conditions of a body's points.
template <class MakeBonds>
void complete_body(Body& body, const BodySpecification& of, const MakeBonds& make_bonds,
                   int threads) {
  make_model(body, make_bonds, threads);
  LoadSetting loads = load_setting(body, of);
  take_surface(body, loads, threads);
  body.conditions = std::make_unique<Conditions>(
      body.points, of.supports, of.loads, programme_of(of), of.controls, loads, of.eigenstrains,
      of.constraints, of.foundations, of.obstacles);
  if (loads.surface) {
    refuse_points_on_faces(body.points, *loads.surface, body.conditions->prescribed());
  }
  add_terms_of_conditions(body.model, body);
  const Stopwatch watch(body.seconds_neighbourhood);
  store_interactions(body, threads);
}

/// Bytes of the bonds that so many points are expected to have.
double expected_bytes(const Body& body, const BodySpecification& of) {
  if (body.points.count() == 0) return 0.0;  // there is no estimate for this case
  BodySize expected = size_of(body.points);
  expected.horizon_ratio = reach_ratio(of.volume_correction, of.horizon_shape,
                                       body.points.dimension, body.horizon_ratio());
  if (of.is_convolved()) {
    expected.horizon_ratio =
        setting_of_short_bonds(body.points, body.setting).horizon / body.points.spacing;
  }
  expected.bonds = expected_bonds(expected.points, body.points.dimension, expected.horizon_ratio);
  return estimate_memory(expected).least_bytes();
}

}  // namespace

std::unique_ptr<const Body> make_body(Points points, const BodySpecification& given, int threads) {
  threads = usable_threads(threads);
  check_points(points);
  BodySpecification of = given;
  take_horizons(points, of, SoleRank());
  check_specification(of, points);
  const std::vector<Period> periods(of.constraints.periods.begin(), of.constraints.periods.end());
  add_images(points, of.constraints.symmetries, periods, reach_of_images(of, points, SoleRank()));
  auto body = std::make_unique<Body>();
  begin_body(*body, std::move(points), of);
  const Index own = body->points.own();
  body->index_map = std::make_unique<const IndexMap>(own, body->points.count() - own);
  require_memory_for(*body, expected_bytes(*body, of));
  complete_body(
      *body, of,
      [&](const BondSetting& setting) {
        return make_bonds(body->points, of.surface_correction, setting, threads);
      },
      threads);
  return body;
}

namespace {

/// Refuses features that the assembler of a part does not support; tables of case files are refused
/// before.
void refuse_without_ranks(const BodySpecification& of) {
  const auto refuse = [](const std::string& key) {
    throw InputError(
        key, "",
        "is not for more than one rank yet; supported on several ranks are pre-cracks, supports, "
        "rigid sets, rollers, linear constraints, planes of symmetry, periods, foundations, "
        "obstacles, contacts of points, eigenstrains, tractions, pressures, body forces, total "
        "forces and gravity, and "
        "damage of bonds, points, states and triangles");
  };
  if (of.force_operator != ForceOperator::bonds) refuse("force_operator");
  if (!of.controls.empty()) refuse("controls");
  for (std::size_t k = 0; k < of.contacts.size(); ++k) {
    const std::string table = "contacts[" + std::to_string(k) + "]";
    if (of.contacts[k].shape == ContactShape::faces) refuse(table + ".shape");
    if (of.contacts[k].friction > 0.0) refuse(table + ".friction");
  }
  for (std::size_t k = 0; k < of.obstacles.size(); ++k) {
    const std::string table = "obstacles[" + std::to_string(k) + "]";
    if (of.obstacles[k].friction > 0.0) refuse(table + ".friction");
    if (!of.obstacles[k].force.empty()) refuse(table + ".force");
  }
  if (cuts_struts(of)) refuse("damage.struts");
  for (std::size_t k = 0; k < of.loads.size(); ++k) {
    const LoadSpecification::Kind kind = of.loads[k].kind;
    if (kind == LoadSpecification::Kind::stress && !takes(of, Option::surface_loads)) {
      refuse("loads[" + std::to_string(k) + "]." + load_key(kind));
    }
  }
}

}  // namespace

std::unique_ptr<const Body> make_body(Part part, const BodySpecification& given,
                                      const Communicator& ranks, int threads) {
  threads = usable_threads(threads);
  refuse_without_ranks(given);
  part.points.owned = part.owned;
  BodySpecification of = given;
  take_horizons(part.points, of, ranks);
  check_specification(of, part.points);
  add_images(part.points, part.images, part.reach);
  auto body = std::make_unique<Body>();
  begin_body(*body, part.points, of);
  body->index_map = std::make_unique<const IndexMap>(make_index_map(part, ranks));
  require_memory_for(*body, expected_bytes(*body, of));
  complete_body(
      *body, of,
      [&](const BondSetting& setting) {
        return make_bonds(part, of.surface_correction, setting, ranks, threads,
                          formulation_of(of).part_bonds);
      },
      threads);
  return body;
}

void add_terms_of_conditions(Model& model, const Body& body) {
  if (body.conditions->has_pressures()) {
    const PressedBoundary& boundary = body.conditions->pressed_boundary();
    model.add(std::make_shared<PressureTerm>(body.points, boundary));
  }
  const Foundations& foundations = body.conditions->foundations();
  if (!foundations.none()) model.add(std::make_shared<FoundationTerm>(body.points, foundations));
  add_contacts(body, model);
  const Obstacles& obstacles = body.conditions->obstacles();
  if (!obstacles.none()) model.add(std::make_shared<ObstacleTerm>(body.points, obstacles));
  if (body.specification.has_inertia) model.add(std::make_shared<InertiaTerm>(body.points));
}

}  // namespace peristat
