#include "solvers/study/body.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <omp.h>

#include "assembly/terms/damage.hpp"
#include "assembly/terms/points/point_term.hpp"
#include "assembly/terms/pressure/pressure_term.hpp"
#include "assembly/terms/springs/foundation_term.hpp"
#include "assembly/terms/springs/inertia_term.hpp"
#include "solvers/formulations/check_specification.hpp"
#include "solvers/formulations/convolved/convolved_lattice.hpp"
#include "solvers/linear/available_memory.hpp"
#include "solvers/ranks/sum_on_machine.hpp"
#include "solvers/study/require_memory_for.hpp"
#include "solvers/study/surface_sites.hpp"
#include "src/connectivity/fragments.hpp"
#include "src/connectivity/free_motion.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/core/stopwatch.hpp"
#include "src/core/threads.hpp"
#include "src/geometry/image_kinds.hpp"
#include "src/neighbourhood/horizon.hpp"
#include "src/neighbourhood/share_on_horizon.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Environments that a step holds: of the old state, of the new one, those of differences.
constexpr double states_with_environment = 4.0;

/// Fraction of the bonds above which those on the horizon are a shell of a lattice.
constexpr double least_shell = 0.01;

/// Refuses points so far from the origin that round-off blurs the horizon.
void require_resolved(const Points& points, double horizon) {
  double farthest = 0.0;
  for (const double at : points.reference) farthest = std::max(farthest, std::abs(at));
  if (farthest * std::numeric_limits<double>::epsilon() <= horizon_tolerance * horizon) return;
  throw InputError("points.reference", "",
                   "a point stands at " + number_text(farthest) +
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

/// True if points couple that have a neighbour in common.
bool couples_second_neighbours(const BodySpecification& of) {
  return !of.is_convolved() && formulation_of(of).couples_second_neighbours;
}

/// Sets the counts for a model that couples points with a common neighbour: as many blocks as bonds
/// of twice the horizon.
void reach_twice(BodySize& size) {
  size.has_symmetric_blocks = false;
  size.coupling_ratio = 2.0 * size.horizon_ratio;
  size.blocks = expected_bonds(size.points, size.dimension, size.coupling_ratio);
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
  const Formulation& formulation = formulation_of(of);
  BondSetting setting =
      formulation.setting_of_bonds ? formulation.setting_of_bonds(body.setting) : body.setting;
  return of.is_convolved() ? setting_of_short_bonds(body.points, std::move(setting)) : setting;
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
/// beyond the horizon.
double reach_of_images(const BodySpecification& of, const Points& points) {
  const bool is_whole = of.volume_correction == VolumeCorrection::none;
  return of.horizon * farthest_of(of.horizon_shape, points.dimension) +
         (is_whole ? 0.0 : points.spacing.largest());
}

std::vector<double> at_rest(const Body& body) {
  return std::vector<double>(body.conditions->constraints().dofs(), 0.0);
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
  if (of.end_time) return LoadingProgramme::of_time(*of.end_time);
  return of.programme.empty() ? LoadingProgramme() : LoadingProgramme(of.programme);
}

LoadSetting load_setting(const BodySpecification& of, const Points& points,
                         const IndexMap& index_map) {
  const PointMaterials materials(of, points);
  const bool has_gravity = std::any_of(
      of.loads.begin(), of.loads.end(),
      [](const LoadSpecification& load) { return load.kind == LoadSpecification::Kind::gravity; });
  LoadSetting setting{.horizon = of.horizon, .index_map = index_map};
  setting.density = of_materials(materials, points, &MaterialSpecification::density, "density",
                                 has_gravity ? "gravity" : "");
  setting.thermal_expansion =
      of_materials(materials, points, &MaterialSpecification::thermal_expansion,
                   "thermal_expansion", of.eigenstrains.temperature_change ? "a temperature" : "");
  return setting;
}

}  // namespace

std::vector<ImageKind> kinds_of_images(const BodySpecification& of, const Points& points,
                                       const Communicator& ranks) {
  const std::vector<Period> periods(of.constraints.periods.begin(), of.constraints.periods.end());
  return image_kinds(points, extent_of(points, ranks), of.constraints.symmetries, periods,
                     reach_of_images(of, points));
}

BondSetting bond_setting(const BodySpecification& of, const Points& points) {
  BondSetting setting;
  setting.dimension = points.dimension;
  setting.plane = of.material.plane;
  setting.volume_correction = of.volume_correction;
  setting.shape = of.horizon_shape;
  setting.influence = influence_named(of.material.influence);
  setting.horizon = of.horizon;
  setting.cross_section = points.dimension == 3     ? 1.0
                          : of.cross_section == 0.0 ? points.cross_section()
                                                    : of.cross_section;
  if (points.lattice) setting.lattice = {points.spacing, points.angle, of.surface_correction};
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

double reach_ratio(VolumeCorrection correction, HorizonShape shape, int dimension,
                   double horizon_ratio) {
  const double m = horizon_ratio * farthest_of(shape, dimension), pi = std::numbers::pi;
  if (!Kernel{.volume_correction = correction}.has_exact_shares()) return m;
  if (dimension == 1) return m + 0.5;
  if (dimension == 2) return std::sqrt((pi * m * m + 4.0 * m + 1.0) / pi);
  return std::cbrt(m * m * m + (3.0 * pi * m * m + 6.0 * m + 1.0) * 0.75 / pi);
}

double expected_bonds(double points, int dimension, double horizon_ratio) {
  // No more than there are pairs of points.
  return points * std::min(bonds_per_point(dimension, horizon_ratio), 0.5 * points);
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
  body.specification = with_stretches(of, body.setting, body.points.spacing);
  require_resolved(body.points, body.setting.horizon);
}

/// Makes model and conditions of a body's points.
template <class MakeBonds>
void complete_body(Body& body, const BodySpecification& of, const MakeBonds& make_bonds,
                   int threads) {
  make_model(body, make_bonds, threads);
  LoadSetting loads = load_setting(of, body.points, *body.index_map);
  take_surface(body, loads, threads);
  body.conditions = std::make_unique<Conditions>(body.points, of.supports, of.loads,
                                                 programme_of(of), of.controls, loads,
                                                 of.eigenstrains, of.constraints, of.foundations);
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
  // Such a body needs a stored tangent for products.
  const bool stores_twice = couples_second_neighbours(of);
  if (stores_twice) reach_twice(expected);
  return estimate_memory(expected).bytes(false, stores_twice, {});
}

}  // namespace

std::unique_ptr<const Body> make_body(Points points, const BodySpecification& of, int threads) {
  threads = usable_threads(threads);
  check_points(points);
  check_specification(of, points);
  const std::vector<Period> periods(of.constraints.periods.begin(), of.constraints.periods.end());
  add_images(points, of.constraints.symmetries, periods, reach_of_images(of, points));
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
        "eigenstrains, tractions, pressures, body forces, total forces and gravity, and damage of "
        "bonds, points, states and triangles");
  };
  if (of.force_operator != ForceOperator::bonds) refuse("force_operator");
  if (!of.controls.empty()) refuse("controls");
  for (std::size_t k = 0; k < of.loads.size(); ++k) {
    const LoadSpecification::Kind kind = of.loads[k].kind;
    if (kind == LoadSpecification::Kind::stress && !takes(of, Option::surface_loads)) {
      refuse("loads[" + std::to_string(k) + "]." + load_key(kind));
    }
  }
}

}  // namespace

std::unique_ptr<const Body> make_body(Part part, const BodySpecification& of,
                                      const Communicator& ranks, int threads) {
  threads = usable_threads(threads);
  refuse_without_ranks(of);
  part.points.owned = part.owned;
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
  if (body.specification.has_inertia) model.add(std::make_shared<InertiaTerm>(body.points));
}

BodySize size_of(const Points& points) {
  BodySize size;
  size.dimension = points.dimension;
  size.points = double(points.count());
  size.free_dofs = double(points.reference.size());
  size.places = 1.0;
  for (int c = 0; c < points.dimension; ++c) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (Index i = 0; i < points.count(); ++i) {
      const double at = points.reference[std::size_t(i) * points.dimension + c];
      least = std::min(least, at);
      most = std::max(most, at);
    }
    size.longest = std::max(size.longest, (most - least) / points.spacing + 1.0);
    size.places *= (most - least) / points.spacing.along(c) + 1.0;
  }
  return size;
}

MemoryEstimate estimate_memory(const Body& body) {
  const auto& prescribed = body.conditions->prescribed();
  BodySize size = size_of(body.points);
  size.horizon_ratio = reach_ratio(body.setting.volume_correction, body.setting.shape,
                                   body.points.dimension, body.horizon_ratio());
  size.bonds = double(body.model.bonds().count());
  size.bytes_per_bond = double(sizeof(Index) + body.model.bonds().kind.bytes_per_bond());
  size.has_history = body.model.has_history();
  size.is_convolved = body.model.tangent_kind() == TangentKind::products;
  size.has_symmetric_blocks = body.model.has_symmetric_blocks();
  size.is_constrained = !body.conditions->constraints().none();
  size.free_dofs = double(std::count(prescribed.begin(), prescribed.end(), 0));
  if (!body.index_map->is_whole()) {
    size.ranks = body.index_map->ranks().count();
    size.gathered_points = body.index_map->is_first_rank() ? double(body.index_map->whole()) : 0.0;
  }
  for (const auto& term : body.model.terms()) {
    size.blocks = std::max(size.blocks, double(term->couplings().partner.size()));
  }
  if (couples_second_neighbours(body.specification)) size.coupling_ratio = 2.0 * size.horizon_ratio;
  if (!body.model.balances().potential) {
    // Couplings reach two horizons: 2^d as many points as one.
    const double near = 2.0 * size.bonds / std::max(size.points, 1.0) + 1.0;
    size.entries_per_row =
        size.dimension * std::min(size.points, std::pow(2.0, size.dimension) * near);
  }
  MemoryEstimate estimate = estimate_memory(size);
  for (const auto& term : body.model.terms()) estimate.body_bytes += term->stored_bytes();
  estimate.body_bytes +=
      body.specification.evaluation_bytes_per_point * double(body.points.count());
  if (body.specification.eigenstrains.are_there()) {
    estimate.body_bytes += states_with_environment * sizeof(double) * double(body.points.count());
  }
  return estimate;
}

std::vector<std::string> describe_interactions(const Body& body) {
  std::vector<std::string> lines;
  for (const auto& term : body.model.terms()) {
    if (term->failure()) continue;  // reported separately
    for (const InteractionCount& kind : term->counts()) {
      const auto [least, most] = std::minmax_element(kind.per_point.begin(), kind.per_point.end());
      lines.push_back(
          fmt::format("{} {}; per point {} to {}", kind.count, kind.name, *least, *most));
    }
  }
  const auto* const points = body.model.find<PointTerm>();
  if (points != nullptr && points->has_lattice()) {
    lines.push_back(fmt::format("summed by convolutions over a box of {} sites",
                                points->lattice()->box.count()));
  }
  const InteractionStorage& storage = body.interaction_storage;
  if (storage.needed > 0.0) {
    lines.push_back(fmt::format("{}: storing them takes {}, and {} are free for it",
                                storage.fits() ? "stored" : "found anew in every pass",
                                bytes_text(storage.needed), bytes_text(storage.room)));
  }
  const double on_horizon = share_on_horizon(
      body.model.bonds(), body.setting,
      [&](Index i, Index j) { return norm_between(body.points, i, j, body.setting.shape); });
  if (on_horizon > least_shell) {
    lines.push_back(
        fmt::format("{:.2g} % of the bonds are exactly as long as the horizon, so that round-off "
                    "decides which points are neighbours; a ratio between the distances of the "
                    "lattice, such as 3.015, or a volume_correction avoids this",
                    100.0 * on_horizon));
  }
  return lines;
}

std::vector<std::string> describe_constraints(const Body& body) {
  std::vector<std::string> lines;
  for (const Foundations::Summary& of : body.conditions->foundations().summaries()) {
    lines.push_back(fmt::format("{}: {} springs, {} N/m in all", of.name, of.springs,
                                place_text(of.stiffness, body.points.dimension)));
  }
  std::size_t rigid = 0;
  const auto& sets = body.conditions->constraints().rigid_sets();
  for (const Restraint& restraint : body.conditions->restraints()) {
    switch (restraint.kind) {
      case Restraint::Kind::rigid_set: {
        const Constraints::RigidSet& set = sets[rigid++];
        lines.push_back(fmt::format("{}: {} points move as one rigid body about {} m",
                                    restraint.name, set.members.size(),
                                    place_text(set.centre, body.points.dimension)));
        break;
      }
      case Restraint::Kind::rollers:
        lines.push_back(fmt::format("{}: held along {} only", restraint.name,
                                    place_text(restraint.direction, body.points.dimension)));
        break;
      case Restraint::Kind::linear:
        lines.push_back(fmt::format("{}: linear constraint", restraint.name));
        break;
      case Restraint::Kind::symmetry:
      case Restraint::Kind::period:
        lines.push_back(fmt::format("{}: {} image points within the horizon", restraint.name,
                                    body.points.count() - body.points.own()));
        break;
    }
  }
  return lines;
}

namespace {

/// Describes the parts of the body that may move freely; empty if there are none.
std::string describe_free_motions(const Body& body, const Bonds& bonds) {
  const std::vector<FreeMotion> parts =
      free_motions(body.points, bonds, body.conditions->holding(at_rest(body)), *body.index_map);
  std::string text;
  constexpr std::size_t most_listed = 5;
  for (std::size_t k = 0; k < std::min(parts.size(), most_listed); ++k) {
    const FreeMotion& part = parts[k];
    const std::string place = place_text(part.place, body.points.dimension);
    if (part.points == body.index_map->whole()) {
      text += "the whole body may ";
    } else if (part.points == 1) {
      text += "the isolated point at " + place + " m may ";
    } else {
      text +=
          "a part of " + std::to_string(part.points) + " points, with one at " + place + " m, may ";
    }
    for (std::size_t m = 0; m < part.motions.size(); ++m) {
      text += (m == 0 ? "" : m + 1 == part.motions.size() ? " and " : ", ") + part.motions[m];
    }
    text += "; ";
  }
  if (parts.size() > most_listed) {
    text += "so may " + std::to_string(parts.size() - most_listed) + " more parts; ";
  }
  if (!text.empty()) text.resize(text.size() - 2);
  return text;
}

/// Positions of the loose points of all ranks, each with its number; the lowest number first.
std::vector<std::pair<double, Coordinates>> places_of_loose(const Body& body,
                                                            const std::vector<Index>& loose) {
  std::vector<double> flat;
  for (const Index point : loose) {
    const Coordinates at = body.points.position(point);
    flat.push_back(double(body.index_map->number_of(point)));
    flat.insert(flat.end(), at.begin(), at.end());
  }
  flat = concatenated(body.index_map->ranks(), flat);
  std::vector<std::pair<double, Coordinates>> places;
  for (std::size_t k = 0; k < flat.size(); k += 4) {
    places.emplace_back(flat[k], Coordinates{flat[k + 1], flat[k + 2], flat[k + 3]});
  }
  std::sort(places.begin(), places.end());
  return places;
}

/// Describes points that have too few bonds from the start; empty if there are none.
std::string describe_loose_points(const Body& body, const Bonds& bonds) {
  const std::vector<double> rest = at_rest(body);
  const Fragments fragments = find_fragments(body.points, bonds, {}, body.conditions->prescribed(),
                                             rest, body.conditions->holding(rest), *body.index_map);
  const auto places = places_of_loose(body, fragments.loose);
  if (places.empty()) return {};
  return fmt::format("{} {} on too few bonds to be held by them, {}at {} m", places.size(),
                     places.size() == 1 ? "point hangs" : "points hang",
                     places.size() == 1 ? "" : "one of them ",
                     place_text(places.front().second, body.points.dimension));
}

/// Describes a body whose points all lie in one plane across an axis, so that no bond resists their
/// motion along it; empty for other bodies.
std::string describe_flatness(const Body& body) {
  constexpr double flat = 1e-9;  // round-off, relative to the largest extent
  const int dimension = body.points.dimension;
  std::array<double, 3> extent{};
  for (int c = 0; c < dimension; ++c) {
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (Index i = 0; i < body.points.count(); ++i) {
      low = std::min(low, body.points.position(i)[c]);
      high = std::max(high, body.points.position(i)[c]);
    }
    low = body.index_map->ranks().min(low);
    high = body.index_map->ranks().max(high);
    extent[std::size_t(c)] = high - low;
  }
  const double largest = std::max({extent[0], extent[1], extent[2]});
  for (int c = 0; c < dimension; ++c) {
    if (extent[std::size_t(c)] > flat * largest) continue;
    const char axis = "xyz"[c];
    return fmt::format(
        "all points stand at the same {0}, so that no bond resists their motion along {0}: give "
        "the "
        "body two layers or more across it, prescribe that displacement everywhere, or model it in "
        "{1} dimension{2}",
        axis, dimension - 1, dimension == 2 ? "" : "s");
  }
  return {};
}

}  // namespace

void refuse_unheld_bodies(const Body& body) {
  const auto is_held_by = [&](const Bonds& bonds) {
    return describe_free_motions(body, bonds).empty() && describe_loose_points(body, bonds).empty();
  };
  if (is_held_by(body.model.bonds())) return;
  const std::shared_ptr<const Bonds> bonds = whole_network(body.model);
  const std::string motions = describe_free_motions(body, *bonds);
  if (!motions.empty()) {
    throw InputError("supports", "",
                     "the supports do not hold the body: " + motions +
                         ". Prescribe displacements that prevent this");
  }
  const std::string loose = describe_loose_points(body, *bonds);
  const std::string flatness = describe_flatness(body);
  if (!loose.empty() && !flatness.empty()) throw InputError("points", "", flatness);
  if (!loose.empty()) {
    throw InputError(body.specification.cracks.empty() ? "points" : "cracks", "",
                     loose +
                         ". Remove such points, move what cuts them off, or give them more bonds "
                         "(a larger horizon)");
  }
}

}  // namespace peristat
