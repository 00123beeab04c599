#include "cases/runner/setup/preflight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <variant>

#include <fmt/format.h>

#include "assembly/terms/damage.hpp"
#include "assembly/terms/points/point_term.hpp"
#include "cases/runner/setup/body.hpp"
#include "cases/runner/setup/lattice_rows.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/formulations/materials/bond_materials.hpp"
#include "src/core/expression.hpp"
#include "src/core/infinity.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/counts_bond.hpp"
#include "src/geometry/local_spacing.hpp"
#include "src/geometry/mesh_body.hpp"
#include "src/geometry/mesh_interior.hpp"
#include "src/geometry/solid.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

const char* kind_of(const Shape& shape) {
  constexpr std::array names{"box",     "disk",    "cylinder", "sphere",
                             "polygon", "ellipse", "image",    "stl"};
  return names[shape.index()];
}

/// True if boxes of the body consist of whole cells along the axes.
bool has_whole_cells(const Lattice& lattice) {
  return lattice.arrangement == Arrangement::lattice && lattice.angle == 0.0 &&
         lattice.volumes == CellVolumes::whole;
}

/// Divisions of all added boxes into cells; cells are counted from the corner of the first box.
std::vector<Preflight::Division> divisions_of(const Lattice& lattice) {
  std::vector<Preflight::Division> divisions;
  if (!has_whole_cells(lattice)) return divisions;
  constexpr double round_off = 1e-9;
  const bool has_nodes = lattice.origin == LatticeOrigin::nodes;
  const auto* const first = std::get_if<Box>(&lattice.shapes.front().shape);
  for (std::size_t k = 0; first != nullptr && k < lattice.shapes.size(); ++k) {
    const auto* const box = std::get_if<Box>(&lattice.shapes[k].shape);
    if (box == nullptr || lattice.shapes[k].action != ShapeStep::Action::add) continue;
    for (std::size_t c = 0; c < std::size_t(lattice.dimension); ++c) {
      const double spacing = lattice.spacing.along(int(c));
      const double anchor = first->min[c] + (has_nodes ? 0.0 : 0.5 * spacing);
      const double low = std::ceil((box->min[c] - anchor) / spacing - round_off);
      const double high = std::floor((box->max[c] - anchor) / spacing + round_off);
      const double cells = high - low + (has_nodes ? 0.0 : 1.0);
      if (cells < 1.0) continue;
      divisions.push_back({"lattice.shape[" + std::to_string(k) + "]", int(c),
                           box->max[c] - box->min[c], cells * spacing, cells});
    }
  }
  return divisions;
}

/// All bonds of a body; null if a convolved body has too many to find them for this.
std::shared_ptr<const Bonds> network_of(const Body& body) {
  const auto* const term = body.model.find<PointTerm>();
  if (term == nullptr || !term->has_lattice()) {
    return {std::shared_ptr<const Bonds>(), &body.model.bonds()};
  }
  constexpr Offset most = 5'000'000;  // some seconds
  return body.model.failure().count_of_bonds() > most ? nullptr : whole_network(body.model);
}

/// Number of bonds that bridge a narrow shape: the part of a bond in the shape is at least as long
/// as the shape is wide (half of that for shapes other than boxes).
std::int64_t bridging(const Body& body, const Bonds& bonds, const Shape& shape, double width) {
  const Points& points = body.points;
  constexpr double round_off = 1e-6;
  const double least = std::holds_alternative<Box>(shape) ? width * (1.0 - round_off) : 0.5 * width;
  const Box around = bounds(shape);
  std::int64_t count = 0;
  for (Index i = 0; i < bonds.points(); ++i) {
    const Coordinates at = points.position(i);
    bool is_near = true;
    for (std::size_t c = 0; c < std::size_t(points.dimension); ++c) {
      is_near = is_near && at[c] >= around.min[c] - body.setting.reach() &&
                at[c] <= around.max[c] + body.setting.reach();
    }
    if (!is_near) continue;
    for (Offset bond = bonds.offset[std::size_t(i)]; bond < bonds.offset[std::size_t(i) + 1];
         ++bond) {
      const Index j = bonds.partner(i, bond);
      if (!counts_bond(points, i, j)) continue;
      count += length_inside(shape, points.dimension, at, points.position(j)) >= least;
    }
  }
  return count;
}

std::vector<Preflight::Opening> openings_of(const Lattice& lattice, const Body& body,
                                            const Communicator& ranks) {
  std::vector<Preflight::Opening> openings;
  const Box box = Solid(lattice.dimension, lattice.shapes).bounds();
  std::shared_ptr<const Bonds> bonds;
  for (std::size_t k = 0; k < lattice.shapes.size(); ++k) {
    const ShapeStep& step = lattice.shapes[k];
    if (step.action == ShapeStep::Action::add || !has_smooth_sides(step.shape)) continue;
    Preflight::Opening opening{"lattice.shape[" + std::to_string(k) + "]", kind_of(step.shape),
                               width_of(step.shape, lattice.dimension, box), 0, step.cuts_bonds};
    constexpr double round_off = 1e-6;
    const bool is_narrow = opening.width < body.setting.horizon * (1.0 - round_off);
    if (is_narrow && !opening.cuts_bonds) {
      if (!bonds) bonds = network_of(body);
      const std::int64_t here = bonds ? bridging(body, *bonds, step.shape, opening.width) : 0;
      opening.bridging = ranks.count_all(here).all;
    }
    openings.push_back(std::move(opening));
  }
  return openings;
}

/// Finds the range of an expression over the points that it acts on.
class Values {
 public:
  Values(const Case& from, const Body& body, const Communicator& ranks)
      : from_(from), body_(body), ranks_(ranks), programme_(body.conditions->programme()) {
    const auto* const lattice = std::get_if<Lattice>(&from.body);
    spacing_ = lattice != nullptr ? lattice->spacing : Spacing(1.0);
  }

  [[nodiscard]] Preflight::Applied of(const GivenValue& given) const {
    const Expression expression(given.text, given.has_place ? from_.dimension : 0, spacing_,
                                from_.parameters(), body_.points.columns, from_.givens->functions);
    const auto typed = from_.typed.find(given.key);
    Preflight::Applied value{given.kind, given.key, given.where, given.unit,
                             typed == from_.typed.end() ? given.text : typed->second};
    value.changes = expression.has_parameters();
    const std::vector<Place> places = places_of(given, expression);
    constexpr int most_entries = 100;  // between the first and the last
    const int last = programme_.is_of_time() ? 1 : int(programme_.end());
    const int stride = std::max(1, last / most_entries);
    const Range begin = range(expression, places, 0.0);
    const Range end = range(expression, places, programme_.end());
    double largest = std::max(begin.largest(), end.largest());
    for (int k = stride; k < last && value.changes; k += stride) {
      largest = std::max(largest, range(expression, some_of(places), double(k)).largest());
    }
    const std::vector<double> all =
        ranks_.max({-begin.least, begin.most, -end.least, end.most, largest});
    value.begin = Range{-all[0], all[1]}.told();
    value.end = Range{-all[2], all[3]}.told();
    value.largest = all[4];
    return value;
  }

 private:
  struct Place {
    Coordinates at{};
    Index point = Expression::no_point;
  };

  struct Range {
    double least = infinity, most = -infinity;
    [[nodiscard]] double largest() const {
      return least <= most ? std::max(std::abs(least), std::abs(most)) : 0.0;
    }
    [[nodiscard]] std::array<double, 2> told() const {
      return least <= most ? std::array{least, most} : std::array{0.0, 0.0};
    }
  };

  [[nodiscard]] static std::vector<Place> some_of(const std::vector<Place>& places) {
    constexpr std::size_t most = 100;
    const std::size_t stride = std::max<std::size_t>(1, places.size() / most);
    std::vector<Place> some;
    for (std::size_t k = 0; k < places.size(); k += stride) some.push_back(places[k]);
    return some;
  }

  /// Places to evaluate an expression at: a few thousand of the points if there are many.
  [[nodiscard]] std::vector<Place> places_of(const GivenValue& given,
                                             const Expression& expression) const {
    if (!given.has_place || expression.is_constant()) return {Place{}};
    if (given.at) return {Place{*given.at}};
    const auto set = body_.points.sets.find(given.set);
    const bool is_of_set = set != body_.points.sets.end();
    const Index count = is_of_set ? Index(set->second.size()) : body_.points.own();
    constexpr Index most_places = 5000;
    const Index stride = std::max<Index>(1, count / most_places);
    std::vector<Place> places;
    for (Index k = 0; k < count; k += stride) {
      const Index point = is_of_set ? set->second[std::size_t(k)] : k;
      places.push_back({body_.points.position(point), point});
    }
    return places;
  }

  /// Values at places, all at once unless some have none.
  [[nodiscard]] static std::vector<double> values(const Expression& expression,
                                                  const std::vector<Place>& places,
                                                  const std::vector<double>& parameters) {
    std::vector<Coordinates> at;
    std::vector<Index> points;
    for (const Place& place : places) {
      at.push_back(place.at);
      points.push_back(place.point);
    }
    try {
      return expression.at(at, parameters, points);
    } catch (const InputError&) {
      std::vector<double> some;
      for (const Place& place : places) {
        try {
          some.push_back(expression(place.at, parameters, place.point));
        } catch (const InputError&) {
          continue;
        }
      }
      return some;
    }
  }

  /// Range of values, leaving out places where the expression is undefined: it acts on no point
  /// there.
  [[nodiscard]] Range range(const Expression& expression, const std::vector<Place>& places,
                            double stage) const {
    std::vector<double> parameters = programme_.at(stage);
    // The load under displacement control is not known: values are given for a load of 1.
    if (body_.conditions->control() != nullptr && stage > 0.0) parameters.front() = 1.0;
    Range range;
    for (const double value : values(expression, places, parameters)) {
      range.least = std::min(range.least, value);
      range.most = std::max(range.most, value);
    }
    return range;
  }

  const Case& from_;
  const Body& body_;
  const Communicator& ranks_;
  const LoadingProgramme& programme_;
  Spacing spacing_;
};

/// "region[0].material" for "regions[0].material".
std::string key_in_case(std::string key) {
  for (const std::string table : {"regions[", "interfaces["}) {
    if (key.starts_with(table)) key.erase(table.size() - 2, 1);
  }
  return key;
}

/// Adds the stiffnesses of all materials, and their fracture data if these are quickly known.
void add_materials(const Case& from, const Body& body, Preflight& to) {
  const BodySpecification& of = body.specification;  // its stretches are computed
  const PointMaterials materials(of, body.points), as_given(from, body.points);
  const auto found = all_materials(of, materials), given = all_materials(from, as_given);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const MaterialSpecification& material = *found[k].of;
    const std::string key = key_in_case(found[k].key);
    if (material.youngs_modulus) {
      to.stiffnesses.push_back({key + ".youngs_modulus", *material.youngs_modulus});
    }
    const DamageSpecification& damage = material.damage;
    if (const auto& warning = formulation_of(of).fracture_warning) {
      const std::string text = warning(material, key, body.setting, body.points.spacing);
      if (!text.empty()) to.of_materials.push_back(text);
    }
    to.may_fail = to.may_fail || damage.law != DamageLaw::none;
    const bool has_strength = formulation_of(of).has_quick_fracture_scale && !material.fibre;
    if (!has_strength || !damage.breaks_bonds()) continue;
    const FractureScale scale =
        fracture_scale_of(material, found[k].key, body.setting, body.points.spacing);
    const double strength = scale.strength(damage);
    // A lattice without shear stiffness has none; where a pull fails no bond it is infinite.
    if (strength == 0.0 || !std::isfinite(strength)) continue;
    const DamageSpecification& asked = given[k].of->damage;
    to.fractures.push_back({of.regions.empty() ? "" : found[k].name, key, scale.youngs_modulus,
                            scale.energy(damage), strength, damage.critical,
                            asked.strength || asked.onset > 0.0 || !asked.has_fracture_energy(),
                            asked.strength.has_value(), damage.softens()});
  }
}

/// Keys that are given but not used. Tables of other modes don't count: a case may have them for a
/// mode that --set chooses.
std::vector<Preflight::Idle> idle_keys(const Case& from) {
  const Mode mode = from.solver.mode;
  const auto* const lattice = std::get_if<Lattice>(&from.body);
  const bool has_seed = lattice != nullptr && lattice->seed != Lattice().seed;
  const bool is_random =
      lattice != nullptr && (lattice->arrangement == Arrangement::blue_noise ||
                             lattice->perturbation > 0.0 || lattice->cell_perturbation > 0.0);
  std::vector<Preflight::Idle> idle;
  const auto add = [&](bool is_idle, const char* key, const char* needs) {
    if (is_idle) idle.push_back({key, needs});
  };
  add(has_seed && !is_random, "lattice.seed",
      "perturbation, cell_perturbation or points = \"blue_noise\"");
  add(from.solver.elastic_horizon_ratio > 0.0 && mode != Mode::adaptive,
      "solver.elastic_horizon_ratio", "solver.mode = \"adaptive\"");
  add(from.loading.max_broken_bonds > 0 && mode == Mode::relaxation, "loading.max_broken_bonds",
      "implicit steps, as in solver.mode = \"newton\"");
  add(from.fatigue.crack_damage != FatigueOptions().crack_damage && !from.fatigue.growth.acts(),
      "fatigue.crack_damage", "fatigue.growth");
  const auto* const source = std::get_if<PointSource>(&from.body);
  const bool has_boundary = source != nullptr && source->is_mesh() && source->cut_bonds;
  add(from.output.count_cracks && from.cracks.empty() && cracks_of_shapes(from).empty() &&
          !has_boundary,
      "output.count_cracks", "a [[crack]]");
  return idle;
}

/// Extents of the shapes, or of the positions of points from a file [m]. Collective.
std::vector<double> extents_of(const Case& from, const Body& body, const Communicator& ranks) {
  const auto d = std::size_t(from.dimension);
  std::vector<double> low(d, infinity), high(d, -infinity), extents;
  if (const auto* const lattice = std::get_if<Lattice>(&from.body)) {
    const Box box = Solid(lattice->dimension, lattice->shapes).bounds();
    for (std::size_t c = 0; c < d; ++c) extents.push_back(box.max[c] - box.min[c]);
    return extents;
  }
  for (Index i = 0; i < body.points.own(); ++i) {
    const Coordinates at = body.points.position(i);
    for (std::size_t c = 0; c < d; ++c) {
      low[c] = std::min(low[c], at[c]);
      high[c] = std::max(high[c], at[c]);
    }
  }
  low = ranks.min(low);
  high = ranks.max(high);
  for (std::size_t c = 0; c < d; ++c) extents.push_back(high[c] - low[c]);
  return extents;
}

void take_lattice(const Case& from, const Lattice& lattice, const Body& body,
                  const Communicator& ranks, Preflight& to) {
  to.divisions = divisions_of(lattice);
  to.lengths = feature_lengths(lattice, from.cracks);
  // The body continues across planes of symmetry and periods.
  const auto ends_across = [&](int axis) {
    const auto is_across = [axis](const auto& side) { return side.axis == axis; };
    return std::ranges::none_of(from.constraints.periods, is_across) &&
           std::ranges::none_of(from.constraints.symmetries, is_across);
  };
  for (int axis = 0; axis < from.dimension; ++axis) {
    if (ends_across(axis)) {
      to.lengths.push_back({FeatureLength::Kind::body, std::string("body along ") + "xyz"[axis],
                            to.extents[std::size_t(axis)]});
    }
  }
  to.openings = openings_of(lattice, body, ranks);
}

void take_cross_section(const Case& from, const Body& body, Preflight& to) {
  if (from.dimension == 3) return;
  const std::string table = std::holds_alternative<Lattice>(from.body) ? "lattice." : "points.";
  to.cross_section_key = table + (from.dimension == 1 ? "area" : "thickness");
  to.cross_section = body.setting.cross_section;
  to.cross_section_is_given = from.locations.contains(to.cross_section_key);
  // Plane cpd does not depend on the thickness, and plane strain is reported per metre of it.
  const bool is_plane = takes(from, Option::plane) && from.material.plane == PlaneState::stress;
  to.cross_section_counts = from.dimension == 1 || is_plane;
}

Coordinates middle_of(const Crack& crack) {
  std::vector<Coordinates> vertices;
  if (const auto* const segment = std::get_if<CrackSegment>(&crack)) {
    vertices = {segment->from, segment->to};
  } else if (const auto* const polygon = std::get_if<CrackPolygon>(&crack)) {
    vertices = polygon->vertices;
  } else if (const auto* const outline = std::get_if<CrackOutline>(&crack)) {
    for (const auto& [x, y] : outline->vertices) vertices.push_back({x, y, 0.0});
  }
  Coordinates middle{};
  for (const Coordinates& at : vertices) {
    for (std::size_t c = 0; c < 3; ++c) middle[c] += at[c] / double(vertices.size());
  }
  return middle;
}

/// Refuses a [[crack]] that cuts no bond (these tables come first). A crack within a subtracted
/// shape, as along the middle of a notch, may cut none: with a refined spacing, no bond bridges the
/// notch.
void refuse_idle_cracks(const Case& from, const std::vector<Preflight::CutByCrack>& cracks) {
  const auto* const lattice = std::get_if<Lattice>(&from.body);
  for (std::size_t k = 0; k < from.cracks.size(); ++k) {
    const Coordinates middle = middle_of(from.cracks[k]);
    const bool is_in_air =
        lattice != nullptr && std::ranges::any_of(lattice->shapes, [&](const ShapeStep& step) {
          return step.action == ShapeStep::Action::subtract && contains(step.shape, middle);
        });
    if (cracks[k].bonds > 0 || is_in_air) continue;
    throw InputError("cracks[" + std::to_string(k) + "]", "",
                     "cuts no bond: it lies outside the body, or where no points interact; check "
                     "that its coordinates are in metres");
  }
}

Preflight::OfMesh mesh_facts(const Body& body) {
  const Points& points = body.points;
  Preflight::OfMesh of;
  of.elements = element_counts(*points.mesh);
  const auto spacings = local_spacings(points, body.setting.horizon);
  const auto [finest, coarsest] = std::ranges::minmax(spacings);
  of.finest_spacing = finest;
  of.coarsest_spacing = coarsest;
  of.has_horizons = !points.horizons.empty();
  of.remarks = points.mesh->remarks;
  of.cuts_bonds = points.interior != nullptr;
  of.leaving = std::ranges::count_if(body.cut_bonds, [&](const BondEnds& bond) {
    const auto& [i, j] = bond;
    const auto [a, b] = std::minmax({points.position(i), points.position(j)});
    return of.cuts_bonds && points.interior->leaves(a, b, points.images.kinds);
  });
  return of;
}

}  // namespace

const FeatureLength* Preflight::shortest(FeatureLength::Kind kind) const {
  const FeatureLength* least = nullptr;
  for (const FeatureLength& length : lengths) {
    if (length.kind == kind && (least == nullptr || length.size < least->size)) least = &length;
  }
  return least;
}

Preflight preflight_of(const Case& from, const Body& body, const Communicator& ranks) {
  Preflight of;
  of.dimension = from.dimension;
  of.spacing = body.points.spacing;
  of.horizon = body.setting.horizon;
  of.extents = extents_of(from, body, ranks);
  take_cross_section(from, body, of);
  const std::vector<std::int64_t> met =
      bonds_met_by_each(body.specification.cracks, body.cut_bonds, body.points);
  for (std::size_t k = 0; k < from.cracks.size(); ++k) {
    of.cracks.push_back({"crack[" + std::to_string(k) + "]", ranks.count_all(met[k]).all});
  }
  refuse_idle_cracks(from, of.cracks);
  if (const auto* const lattice = std::get_if<Lattice>(&from.body)) {
    take_lattice(from, *lattice, body, ranks, of);
  }
  if (body.points.mesh) of.mesh = mesh_facts(body);
  const Values values(from, body, ranks);
  for (const GivenValue& given : given_values(from)) {
    if (given.kind != GivenValue::Kind::expected) of.applied.push_back(values.of(given));
  }
  add_materials(from, body, of);
  of.is_quasi_static = !from.dynamics.is_asked_for;
  of.is_controlled = !from.controls.empty();
  of.has_functions = !from.givens->functions.empty();
  of.steps = from.loading.steps_to_entry() * std::max(1, int(body.conditions->programme().end()));
  if (!of.is_quasi_static) of.steps = 1;
  of.begins_moving = !from.initial.empty();
  of.has_notch = !of.cracks.empty() || !of.openings.empty();
  of.along_rows = cracks_along_rows(from);
  of.idle = idle_keys(from);
  return of;
}

namespace {

/// "0.1 x 0.2"
std::string product_text(const std::vector<double>& factors) {
  std::string text;
  for (const double factor : factors)
    text += fmt::format("{}{:g}", text.empty() ? "" : " x ", factor);
  return text;
}

std::string range_text(const std::array<double, 2>& range) {
  return range[0] == range[1] ? fmt::format("{:.6g}", range[0])
                              : fmt::format("{:.6g} to {:.6g}", range[0], range[1]);
}

std::string body_text(const Preflight& of) {
  std::vector<double> spacings;
  for (const double extent : of.extents) spacings.push_back(extent / of.spacing);
  std::string text = product_text(of.extents) + " m";
  if (of.dimension == 2) text += fmt::format(", thickness {:g} m", of.cross_section);
  if (of.dimension == 1) text += fmt::format(", area {:g} m2", of.cross_section);
  return text + fmt::format("; {} spacings", product_text(spacings));
}

std::string length_text(const Preflight& of, const FeatureLength& length) {
  return fmt::format("{}, {:.6g} m: {:.4g} spacings, {:.3g} horizons", length.what, length.size,
                     length.size / of.spacing, length.size / of.horizon);
}

std::string applied_text(const Preflight& of, const Preflight::Applied& value) {
  const char* const begin = of.is_quasi_static ? "at load 0" : "at time 0";
  const std::string end =
      of.is_controlled && value.changes ? "at load 1 (the load is found)" : "at the end";
  return fmt::format("{}{}: {} {} {}, {} {} {}", value.key,
                     value.where.empty() ? "" : " (" + value.where + ")", range_text(value.begin),
                     value.unit, begin, range_text(value.end), value.unit, end);
}

std::string mesh_text(const Preflight::OfMesh& mesh) {
  return fmt::format("{}; spacing around a point {:.4g} to {:.4g} m; {}", mesh.elements,
                     mesh.finest_spacing, mesh.coarsest_spacing,
                     mesh.cuts_bonds ? fmt::format("its boundary cuts {} bonds", mesh.leaving)
                                     : "its boundary cuts no bonds");
}

/// A note, no warning: in mode I a crack stays in its row anyway.
std::string rows_text(const Preflight& of) {
  return fmt::format(
      "{}: within {:g} degrees of a row of the lattice, along an axis or a diagonal; if the load "
      "is "
      "not that of mode I, a crack may stay in the row where it should turn; points without rows "
      "are lattice.points = \"blue_noise\", or those of a file",
      fmt::join(of.along_rows, ", "), along_row);
}

std::string zone_text(const Preflight& of, const Preflight::Fracture& fracture) {
  const double zone = fracture.characteristic_length();
  std::string text = fmt::format("{}strength {:.4g} MPa, E G/ft^2 = {:.4g} m: {:.3g} spacings",
                                 fracture.name.empty() ? "" : fracture.name + ": ",
                                 fracture.strength * 1e-6, zone, zone / of.spacing);
  if (const FeatureLength* const ligament = of.shortest(FeatureLength::Kind::ligament)) {
    text += fmt::format(", {:.3g} of the shortest ligament", zone / ligament->size);
  }
  return text;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> preflight_lines(const Preflight& of) {
  std::vector<std::pair<std::string, std::string>> lines{{"body", body_text(of)}};
  for (const auto kind : {FeatureLength::Kind::ligament, FeatureLength::Kind::opening}) {
    const FeatureLength* const least = of.shortest(kind);
    if (least == nullptr) continue;
    const bool is_opening = kind == FeatureLength::Kind::opening;
    lines.emplace_back(is_opening ? "opening" : "ligament", length_text(of, *least));
  }
  for (const Preflight::Opening& opening : of.openings) {
    if (!opening.cuts_bonds && opening.bridging == 0) continue;
    lines.emplace_back("opening", opening.cuts_bonds ? opening.key + " cuts the bonds that cross it"
                                                     : fmt::format("{} bonds bridge {}",
                                                                   opening.bridging, opening.key));
  }
  if (of.mesh) {
    lines.emplace_back("mesh", mesh_text(*of.mesh));
    for (const std::string& remark : of.mesh->remarks) lines.emplace_back("mesh", remark);
  }
  for (const auto& [key, bonds] : of.cracks) {
    lines.emplace_back("crack", fmt::format("{} cuts {} bonds", key, bonds));
  }
  if (!of.along_rows.empty()) lines.emplace_back("rows", rows_text(of));
  for (const Preflight::Applied& value : of.applied) {
    if (value.largest > 0.0) lines.emplace_back("applied", applied_text(of, value));
  }
  for (const Preflight::Fracture& fracture : of.fractures) {
    if (fracture.softens) lines.emplace_back("zone", zone_text(of, fracture));
  }
  return lines;
}

}  // namespace peristat
