#include "src/conditions/conditions.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "src/conditions/points_of_set.hpp"
#include "src/conditions/traction.hpp"
#include "src/conditions/with_key.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/core/table_calls.hpp"
#include "src/geometry/body_cells.hpp"
#include "src/geometry/expression_at_points.hpp"
#include "src/geometry/nearest_point.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

std::vector<Index> all_points(const Points& points) {
  std::vector<Index> all(std::size_t(points.own()));
  std::iota(all.begin(), all.end(), Index(0));
  return all;
}

/// All points but those of layers.
std::vector<Index> points_of_body(const Points& points) {
  std::vector<char> is_outside(std::size_t(points.own()), 0);
  if (points.lattice) {
    for (const std::string& layer : points.lattice->layers) {
      for (const Index point : points.sets.at(layer)) is_outside[std::size_t(point)] = 1;
    }
  }
  std::vector<Index> inside = all_points(points);
  std::erase_if(inside, [&](Index point) { return is_outside[std::size_t(point)] != 0; });
  return inside;
}

}  // namespace

namespace {

bool acts_on_surface(const LoadSpecification& load) {
  using Kind = LoadSpecification::Kind;
  return load.kind == Kind::traction || load.kind == Kind::pressure || load.kind == Kind::stress;
}

void refuse_depth_of_surface(const LoadSpecification& load, const std::string& table) {
  const bool is_of_surface = load.depth == Depth::surface ||
                             load.kind == LoadSpecification::Kind::stress || !load.boundary.empty();
  if (!is_of_surface) return;
  const std::string key = load.depth == Depth::surface ? ".depth"
                          : load.boundary.empty()      ? ".stress"
                                                       : ".boundary";
  throw InputError(table + key, "",
                   "is for tractions on the surface, which only model \"lps\" has");
}

}  // namespace

Conditions::Conditions(const Points& points, const std::vector<SupportSpecification>& supports,
                       const std::vector<LoadSpecification>& loads, LoadingProgramme programme,
                       const std::vector<ControlTerm>& control, const LoadSetting& setting,
                       const Eigenstrains& eigenstrains, const ConstraintSpecification& constraints,
                       const std::vector<FoundationSpecification>& foundations,
                       const std::vector<ObstacleSpecification>& obstacles)
    : points_(points),
      ranks_(setting.index_map.ranks()),
      programme_(std::move(programme)),
      prescribed_(points.reference.size(), 0),
      made_{Constraints(points)} {
  const std::vector<std::string> parameters = programme_.names();
  if (setting.surface) surface_ = SurfaceTractions(*setting.surface);
  for (std::size_t k = 0; k < supports.size(); ++k) {
    const std::string table = indexed("supports", k);
    const std::vector<Index>& members = points_of_set(points, supports[k].set, table + ".set");
    for (int c = 0; c < points.dimension; ++c) {
      const auto& text = supports[k].displacement[c];
      if (!text) continue;
      const std::string key = indexed(table + ".displacement", std::size_t(c));
      prescriptions_.push_back({key, supports[k].set, &members, c, with_key(key, [&] {
                                  return expression_of(*text, points, parameters);
                                })});
      for (Index point : members) prescribed_[std::size_t(point) * points.dimension + c] = 1;
    }
  }
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const std::string table = indexed("loads", k);
    if (setting.surface && acts_on_surface(loads[k])) {
      surface_.add(points, loads[k], parameters, table, prescribed_, ranks_);
      continue;
    }
    refuse_depth_of_surface(loads[k], table);
    if (loads[k].kind == LoadSpecification::Kind::pressure) {
      add_pressure(loads[k], setting, table);
      continue;
    }
    const auto on = std::make_shared<const Loaded>(loaded(loads[k], setting, table));
    const bool total = loads[k].kind == LoadSpecification::Kind::total_force;
    for (int c = 0; c < points.dimension; ++c) {
      const std::string key = indexed(table + ".value", std::size_t(c));
      loads_.push_back({key, on, c, with_key(key, [&] {
                          return total
                                     ? Expression(loads[k].value[c], 0, points.spacing, parameters,
                                                  points.columns, functions_of(points.functions))
                                     : expression_of(loads[k].value[c], points, parameters);
                        })});
    }
  }
  add_eigenstrains(eigenstrains, setting);
  foundations_ = Foundations(points, foundations, parameters, setting.index_map.ranks());
  obstacles_ = Obstacles(points, obstacles, parameters, setting.of_obstacles, ranks_);
  made_ = make_constraints(points, constraints, prescribed_, parameters, setting.index_map);
  refuse_shared_names();
  hold_periodic_cell(constraints, setting);
  prescribe_handles();
  if (!control.empty()) {
    // A follower moves with its masters, so it is not held.
    std::vector<char> held = prescribed_;
    for (std::size_t dof = 0; dof < held.size(); ++dof) {
      if (made_.constraints.dependent()[dof]) held[dof] = 0;
    }
    control_.emplace(points, control, held);
  }
  find_shared();
  find_changes();
  try_stages();
}

void Conditions::find_changes() {
  const auto changes = [](const auto& conditions, const auto& expression_of) {
    return std::any_of(conditions.begin(), conditions.end(), [&](const auto& condition) {
      return expression_of(condition).has_parameters();
    });
  };
  const auto displacement = [](const auto& of) -> const Expression& { return of.displacement; };
  const auto value = [](const auto& of) -> const Expression& { return of.value; };
  changes_.supports = changes(prescriptions_, displacement) || changes(made_.prescriptions, value);
  changes_.loads = changes(loads_, value);
  changes_.environment = changes(eigenstretches_, value) || changes(pressures_, value) ||
                         foundations_.ground_moves() || obstacles_.move() ||
                         surface_.changes_with_parameters();
}

void Conditions::refuse_shared_names() const {
  std::set<std::string> names;
  for (const Prescription& prescription : prescriptions_) names.insert(prescription.set);
  const auto add = [&names](const std::string& name, const std::string& key) {
    if (names.insert(name).second) return;
    throw InputError(key, '"' + name + '"',
                     "there is already a support, constraint, foundation or obstacle of this name; "
                     "their reactions need different names");
  };
  for (const Restraint& restraint : made_.restraints) add(restraint.name, restraint.key);
  for (const auto& of : foundations_.summaries()) add(of.name, of.key);
  for (const auto& of : obstacles_.all()) add(of.name, of.table + ".name");
}

void Conditions::prescribe_handles() {
  prescribed_.resize(constraints().dofs(), 0);
  for (const HandlePrescription& handle : made_.prescriptions) prescribed_[handle.dof] = 1;
  for (const std::size_t dof : made_.unused) prescribed_[dof] = 1;
  for (std::size_t dof = 0; dof < prescribed_.size(); ++dof) {
    prescribed_[dof] |= constraints().dependent()[dof];
  }
}

/// Fixes the point next to the middle of a periodic cell along axes that no support holds: the cell
/// may translate along these without any change. In a motion inertia holds it.
void Conditions::hold_periodic_cell(const ConstraintSpecification& constraints,
                                    const LoadSetting& setting) {
  const bool is_held = !constraints.rigid_sets.empty() || !constraints.rollers.empty() ||
                       !constraints.linear.empty();
  if (constraints.periods.empty() || is_held || programme_.is_of_time()) return;
  for (int c = 0; c < points_.dimension; ++c) {
    const auto holds = [c](const Prescription& support) { return support.component == c; };
    floats_[std::size_t(c)] = !foundations_.hold(c) && std::ranges::none_of(prescriptions_, holds);
  }
  for (const SymmetryPlane& plane : constraints.symmetries) {
    floats_[std::size_t(plane.axis)] = false;
  }
  const std::optional<Index> nearest = point_of_middle(setting);
  for (std::size_t c = 0; nearest && c < std::size_t(points_.dimension); ++c) {
    const std::size_t dof = std::size_t(*nearest) * std::size_t(points_.dimension) + c;
    if (floats_[c]) made_.unused.push_back(dof);
  }
}

std::optional<Index> Conditions::point_of_middle(const LoadSetting& setting) const {
  const Index own = points_.owned.value_or(points_.own());
  std::vector<double> sum(4, 0.0);  // of positions, and number of points
  for (Index i = 0; i < own; ++i) {
    const Coordinates at = points_.position(i);
    for (std::size_t c = 0; c < 3; ++c) sum[c] += at[c];
    sum[3] += 1.0;
  }
  sum = ranks_.sum(sum);
  const Coordinates middle = scaled<3>(1.0 / sum[3], Coordinates{sum[0], sum[1], sum[2]});
  const NearestPoint mine = nearest_point(points_, middle, own);
  // Among points equally near within round-off the lowest number wins, as for a whole body.
  const double least = ranks_.min(mine.distance);
  const bool is_as_near = own > 0 && mine.distance <= least + round_off_of_distances(points_);
  const double number = is_as_near ? double(setting.index_map.number_of(mine.point))
                                   : std::numeric_limits<double>::infinity();
  if (ranks_.min(number) != number || !is_as_near) return std::nullopt;
  return mine.point;
}

void Conditions::require_balance(std::span<const double> force, const std::string& key) const {
  if (floats_ == std::array<bool, 3>{}) return;
  constexpr double round_off = 1e-9;
  const std::size_t d = std::size_t(points_.dimension);
  std::vector<double> sums(6, 0.0);  // of forces, and of their magnitudes
  for (std::size_t dof = 0; dof < force.size(); ++dof) {
    sums[dof % d] += force[dof];
    sums[3 + dof % d] += std::abs(force[dof]);
  }
  sums = ranks_.sum(sums);
  for (std::size_t c = 0; c < d; ++c) {
    if (!floats_[c] || std::abs(sums[c]) <= round_off * sums[3 + c]) continue;
    throw InputError(key, "",
                     "no support holds the cell, and the loads on it add up to " +
                         number_text(sums[c]) + " N along " + "xyz"[c] +
                         ", so a periodic body has no equilibrium. Balance the loads, or hold the "
                         "cell by a support");
  }
}

Conditions::Loaded Conditions::loaded(const LoadSpecification& load, const LoadSetting& setting,
                                      const std::string& table) const {
  using Kind = LoadSpecification::Kind;
  if (load.kind == Kind::traction) {
    TractionAreas areas = with_table(table, [&] {
      return traction_areas(points_, load, setting.horizon, table, setting.index_map.ranks());
    });
    return {std::move(areas.points), std::move(areas.area)};
  }
  Loaded on;
  const bool is_everywhere = load.kind == Kind::gravity && load.set.empty();
  on.points =
      is_everywhere ? points_of_body(points_) : points_of_set(points_, load.set, table + ".set");
  if (points_.owned) {  // the owner applies a ghost's force
    std::erase_if(on.points, [&](Index point) { return point >= *points_.owned; });
  }
  for (const Index point : on.points) on.amount.push_back(points_.volume[point]);
  if (load.kind == Kind::total_force) {
    on.spread_over = std::accumulate(on.amount.begin(), on.amount.end(), 0.0);
    on.spread_over = setting.index_map.ranks().sum(on.spread_over);
  }
  if (load.kind == Kind::gravity) {
    if (setting.density.empty()) {
      throw InputError("material.density", "", "is missing; gravity needs it");
    }
    for (std::size_t k = 0; k < on.points.size(); ++k) {
      on.amount[k] *= setting.density[std::size_t(on.points[k])];
    }
  }
  return on;
}

void Conditions::add_pressure(const LoadSpecification& load, const LoadSetting& setting,
                              const std::string& table) {
  const std::size_t first = pressed_.face.size();
  with_table(table,
             [&] { add_pressed_faces(points_, load, table, pressed_, setting.index_map.ranks()); });
  const std::string key = table + ".value";
  pressures_.push_back({key, first, pressed_.face.size(), with_key(key, [&] {
                          return expression_of(load.value[0], points_, programme_.names());
                        })});
}

void Conditions::add_eigenstrains(const Eigenstrains& eigenstrains, const LoadSetting& setting) {
  const auto add = [&](const std::string& key, const std::string& text, std::vector<Index> points,
                       std::vector<double> factor) {
    eigenstretches_.push_back({key, std::move(points), std::move(factor), with_key(key, [&] {
                                 return expression_of(text, points_, programme_.names());
                               })});
  };
  for (std::size_t k = 0; k < eigenstrains.given.size(); ++k) {
    const auto& [set, strain] = eigenstrains.given[k];
    const std::string table = indexed("eigenstrains", k);
    const std::vector<Index> points =
        set.empty() ? all_points(points_) : points_of_set(points_, set, table + ".set");
    add(table + ".strain", strain, points, std::vector<double>(points.size(), 1.0));
  }
  if (!eigenstrains.temperature_change) return;
  if (setting.thermal_expansion.empty()) {
    throw InputError("material.thermal_expansion", "", "is missing; a temperature needs it");
  }
  add("temperature.change", *eigenstrains.temperature_change, all_points(points_),
      setting.thermal_expansion);
}

SharedEnvironment Conditions::environment(const LoadPoint& at) const {
  const bool ground_moves = foundations_.ground_moves(), obstacles_move = obstacles_.move();
  if (eigenstretches_.empty() && pressures_.empty() && !ground_moves && !obstacles_move &&
      surface_.none()) {
    return nullptr;
  }
  const std::vector<double> loads = parameters(at);
  auto made = std::make_shared<Environment>();
  if (ground_moves) made->ground = foundations_.ground(loads);
  if (obstacles_move) made->obstacles = obstacles_.displacements(loads);
  if (!surface_.none()) made->traction = surface_.at(points_, loads);
  for (auto* const values : {&made->ground, &made->obstacles, &made->traction}) {
    for (double& value : *values) value *= at.preload;
  }
  for (const auto& [key, first, last, value] : pressures_) {
    with_key(key, [&] {
      const std::span<const Coordinates> centres = pressed_.centre;
      for (const double pressure : value.at(centres.subspan(first, last - first), loads)) {
        made->pressure.push_back(at.preload * pressure);
      }
    });
  }
  if (!eigenstretches_.empty()) made->eigenstretch.assign(std::size_t(points_.count()), 0.0);
  for (const auto& [key, points, factor, value] : eigenstretches_) {
    with_key(key, [&] {
      const std::vector<double> values = values_at(value, points_, points, loads);
      for (std::size_t k = 0; k < points.size(); ++k) {
        const double stretch = at.preload * factor[k] * values[k];
        double& sum = made->eigenstretch[std::size_t(points[k])];
        sum += stretch;
        if (!(sum > -1.0)) {
          throw InputError("", '"' + value.text() + '"',
                           "shrinks lengths to zero or below: the eigenstrain is " +
                               number_text(sum) + " at " +
                               place_text(points_.position(points[k]), points_.dimension) +
                               " m; it must be above -1");
        }
      }
    });
  }
  for (Index image = points_.own(); image < points_.count() && !eigenstretches_.empty(); ++image) {
    made->eigenstretch[std::size_t(image)] = made->eigenstretch[std::size_t(points_.source(image))];
  }
  return made;
}

std::vector<double> Conditions::parameters(const LoadPoint& at) const {
  std::vector<double> values = programme_.at(at.stage);
  if (at.load) values.front() = *at.load;
  return values;
}

void Conditions::find_shared() {
  std::vector<const Prescription*> first(prescribed_.size(), nullptr);
  bool is_shared = false;
  for (const Prescription& prescription : prescriptions_) {
    for (Index point : *prescription.points) {
      const Prescription*& of_dof = first[dof_of(prescription, point)];
      is_shared |= of_dof != nullptr;
      if (!of_dof) of_dof = &prescription;
    }
  }
  if (is_shared) first_ = std::move(first);
}

void Conditions::try_stages() {
  std::vector<double> values(prescribed_.size(), 0.0), force(prescribed_.size());
  // A table of a file that is too short is refused before the run.
  const auto try_tables_of_loads = [&](const LoadPoint& at) {
    const std::vector<double> loads = parameters(at);
    for (const Load& load : loads_) {
      if (table_calls(load.value.text()).empty()) continue;
      with_key(load.key,
               [&] { static_cast<void>(values_at(load.value, points_, load.on->points, loads)); });
    }
  };
  const auto try_at = [&](const LoadPoint& at) {
    prescribe(at, values);
    const bool floats = floats_ != std::array<bool, 3>{};
    if (floats) external_force(at, force);
    try_tables_of_loads(at);
    const SharedEnvironment there = environment(at);
    if (obstacles_.are_driven()) obstacles_.refuse_idle_forces(there);
    if (floats && !pressures_.empty()) {
      require_balance(face_forces(pressed_, there->pressure, points_.dimension),
                      pressures_.front().key);
    }
    for (const double value : values) largest_ = std::max(largest_, std::abs(value));
  };
  if (!obstacles_.none()) obstacles_.refuse_overlap(ranks_);
  if (control_) return try_at({0.0, 0.0});  // its loads are not known in advance
  const auto try_share = [&](double share) { try_at(share * programme_.end()); };
  // The end first: it sets largest_.
  for (const double share : {1.0, 0.0, 0.5}) try_share(share);
  if (first_.empty()) return;
  // Fractions of the programme at which two different expressions hardly ever agree.
  for (const double share : {0.0737, 0.1831, 0.2946, 0.3819, 0.6093, 0.7548, 0.8862}) {
    try_share(share);
  }
}

void Conditions::refuse_contradiction(const Prescription& second, Index point, double first_value,
                                      double second_value, double load_factor) const {
  const Prescription& first = *first_[dof_of(second, point)];
  throw InputError(second.key, '"' + second.displacement.text() + '"',
                   "the supports of sets " + first.set + " and " + second.set +
                       " contradict each other: at point " +
                       place_text(points_.position(point), points_.dimension) +
                       " m the displacement in " + "xyz"[second.component] + " is " +
                       number_text(first_value) + " m by the first and " +
                       number_text(second_value) + " m by the second, at load factor " +
                       number_text(load_factor));
}

void Conditions::prescribe(const LoadPoint& at, std::span<double> displacement) const {
  // Two expressions of one value may differ in their last digits: 1e-5*load*3 and 3e-5*load.
  constexpr double same = 1e-12;
  const std::vector<double> loads = parameters(at);
  for (const Prescription& prescription : prescriptions_) {
    with_key(prescription.key, [&] {
      const std::vector<Index>& points = *prescription.points;
      const std::vector<double> values =
          values_at(prescription.displacement, points_, points, loads);
      for (std::size_t k = 0; k < points.size(); ++k) {
        const Index point = points[k];
        const double value = at.preload * values[k];
        double& first = displacement[dof_of(prescription, point)];
        if (first_.empty() || first_[dof_of(prescription, point)] == &prescription) {
          first = value;
        } else if (std::abs(value - first) >
                   same * std::max({std::abs(value), std::abs(first), largest_})) {
          refuse_contradiction(prescription, point, first, value, loads.front());
        }
      }
    });
  }
  prescribe_handles_at(loads, at.preload, displacement);
}

void Conditions::prescribe_handles_at(std::span<const double> loads, double preload,
                                      std::span<double> displacement) const {
  for (const HandlePrescription& handle : made_.prescriptions) {
    with_key(handle.key, [&] {
      displacement[handle.dof] = preload * handle.factor * handle.value(handle.place, loads);
    });
  }
}

void Conditions::external_force(const LoadPoint& at, std::span<double> force) const {
  const std::vector<double> loads = parameters(at);
  std::fill(force.begin(), force.end(), 0.0);
  const auto add_loads = [&] {
    for (const Load& load : loads_) {
      with_key(load.key, [&] {
        const auto& [points, amount, spread_over] = *load.on;
        const std::vector<double> values = values_at(load.value, points_, points, loads);
        for (std::size_t k = 0; k < points.size(); ++k) {
          force[std::size_t(points[k]) * points_.dimension + load.component] +=
              at.preload * values[k] * amount[k] / spread_over;
        }
      });
    }
  };
  if (loads_.empty() || floats_ == std::array<bool, 3>{}) {
    add_loads();
  } else {
    add_loads_of_all(add_loads);
  }
  if (!loads_.empty()) require_balance(force, loads_.front().key);
}

void Conditions::add_loads_of_all(const std::function<void()>& add_loads) const {
  std::exception_ptr mine;
  try {
    add_loads();
  } catch (const InputError&) {
    mine = std::current_exception();
  }
  const bool is_missing = ranks_.max(double(mine != nullptr)) > 0.0;
  if (mine) std::rethrow_exception(mine);
  if (is_missing)
    throw InputError(loads_.front().key, "", "has no value at a point on another rank");
}

std::map<std::string, Coordinates> Conditions::reactions(std::span<const double> gradient,
                                                         std::span<const double> external,
                                                         std::span<const double> displacement,
                                                         const SharedEnvironment& environment,
                                                         const Slips& slips) const {
  std::map<std::string, Coordinates> sums;
  std::set<std::pair<std::string, int>> summed;  // two supports may hold one set in one component
  for (const Prescription& prescription : prescriptions_) {
    if (!summed.emplace(prescription.set, prescription.component).second) continue;
    double& sum = sums[prescription.set][prescription.component];
    for (Index point : *prescription.points) {
      const std::size_t dof = std::size_t(point) * points_.dimension + prescription.component;
      sum += gradient[dof] - external[dof];
    }
  }
  for (const Restraint& restraint : made_.restraints) {
    sums[restraint.name] = reaction_of(restraint, gradient);
  }
  sums.merge(foundations_.forces(displacement, environment));
  for (const auto& [name, action] : obstacles_.actions(displacement, environment, slips)) {
    sums[name] = action.force;
  }
  return sums;
}

namespace {

/// How far images of a kind move when a plane of symmetry moves by 1.
double follows_plane(const ImageKind& kind, const Restraint& plane) {
  const std::size_t axis = std::size_t(plane.axis);
  const bool is_mirrored = kind.mirror[axis] < 0.0;
  if (!plane.opposite) return is_mirrored ? 2.0 : 0.0;
  // Reflections in two planes repeat after twice their distance.
  const double shift = kind.shift[axis] - (is_mirrored ? 2.0 * plane.at : 0.0);
  const double repeats = std::round(shift / (2.0 * (*plane.opposite - plane.at)));
  return (is_mirrored ? 2.0 : 0.0) - 2.0 * repeats;
}

}  // namespace

Coordinates Conditions::reaction_of(const Restraint& restraint,
                                    std::span<const double> gradient) const {
  const std::size_t d = std::size_t(points_.dimension);
  // All ranks know the forces on handles, so rank 0 alone reports them.
  const bool is_told_elsewhere = ranks_.rank() > 0 && !restraint.handles.empty();
  Coordinates sum{};
  if (is_told_elsewhere) return sum;
  switch (restraint.kind) {
    case Restraint::Kind::rigid_set:
    case Restraint::Kind::period:
      for (const Index handle : restraint.handles) {
        for (std::size_t c = 0; c < d; ++c) {
          if (!restraint.is_mirrored[c]) sum[c] = gradient[std::size_t(handle) * d + c];
        }
      }
      break;
    case Restraint::Kind::rollers:
      for (const Index handle : restraint.handles) {
        sum = plus<3>(sum, scaled<3>(gradient[std::size_t(handle) * d], restraint.direction));
      }
      break;
    case Restraint::Kind::linear:
      sum[0] = gradient[std::size_t(restraint.handles.front()) * d];
      break;
    case Restraint::Kind::symmetry:
      // Force conjugate to a displacement of the plane together with all images mirrored in it.
      for (Index image = points_.own(); image < points_.count(); ++image) {
        const std::size_t axis = std::size_t(restraint.axis);
        sum[axis] += follows_plane(points_.image_kind(image), restraint) *
                     gradient[std::size_t(image) * d + axis];
      }
      break;
  }
  return sum;
}

std::map<std::string, Coordinates> Conditions::rotations(
    std::span<const double> displacement) const {
  std::map<std::string, Coordinates> rotations;
  std::size_t k = 0;
  for (const Restraint& restraint : made_.restraints) {
    if (restraint.kind != Restraint::Kind::rigid_set) continue;
    rotations[restraint.name] =
        constraints().rotation(constraints().rigid_sets()[k++], displacement);
  }
  return rotations;
}

std::map<std::string, Coordinates> Conditions::mean_gradients(
    std::span<const double> displacement) const {
  std::map<std::string, Coordinates> gradients;
  const std::size_t d = std::size_t(points_.dimension);
  for (const Restraint& restraint : made_.restraints) {
    if (restraint.kind != Restraint::Kind::period) continue;
    Coordinates& gradient = gradients[restraint.name];
    for (const Index handle : restraint.handles) {
      for (std::size_t c = 0; c < d; ++c) {
        gradient[c] = displacement[std::size_t(handle) * d + c] / restraint.length;
      }
    }
  }
  return gradients;
}

std::map<std::string, Coordinates> Conditions::moments(std::span<const double> displacement,
                                                       std::span<const double> gradient,
                                                       std::span<const double> external) const {
  std::map<std::string, Coordinates> moments;
  const std::size_t d = std::size_t(points_.dimension);
  std::size_t k = 0;
  for (const Restraint& restraint : made_.restraints) {
    if (restraint.kind != Restraint::Kind::rigid_set) continue;
    const Constraints::RigidSet& set = constraints().rigid_sets()[k++];
    Coordinates& sum = moments[restraint.name];
    for (const Index member : set.members) {
      Coordinates arm = minus<3>(points_.position(member), set.centre), force{};
      for (std::size_t c = 0; c < d; ++c) {
        const std::size_t dof = std::size_t(member) * d + c;
        arm[c] += displacement[dof] - displacement[std::size_t(set.translation) * d + c];
        force[c] = gradient[dof] - external[dof];
      }
      sum = plus<3>(sum, cross(arm, force));
    }
  }
  return moments;
}

Coordinates Conditions::moved(Index row, Coordinates at,
                              std::span<const double> displacement) const {
  const auto d = std::size_t(points_.dimension);
  for (std::size_t c = 0; c < d; ++c) at[c] += displacement[std::size_t(row) * d + c];
  return at;
}

void Conditions::add_held_sums(std::span<const double> displacement, Holding& holding) const {
  std::vector<HeldMotion> held;
  for (const HeldSum& sum : made_.held_sums) {
    HeldMotion& motion =
        held.emplace_back(HeldMotion{sum.empty() ? -1 : sum.front().first, {}, {}});
    for (const auto& [point, weight] : sum) {
      const Coordinates at = moved(point, points_.position(point), displacement);
      motion.along = plus<3>(motion.along, weight);
      motion.about = plus<3>(motion.about, cross(at, weight));
      holding.links.push_back({motion.member, point});
    }
  }
  // Each rank has a summand; the lowest rank with a member reports the total.
  std::vector<double> shares, first;
  for (const HeldMotion& motion : held) {
    shares.insert(shares.end(), motion.along.begin(), motion.along.end());
    shares.insert(shares.end(), motion.about.begin(), motion.about.end());
    shares.push_back(motion.member >= 0 ? 1.0 : 0.0);
    first.push_back(motion.member >= 0 ? double(ranks_.rank()) : double(ranks_.count()));
  }
  if (held.empty()) return;
  shares = ranks_.sum(shares);
  first = ranks_.min(first);
  for (std::size_t k = 0; k < held.size(); ++k) {
    const auto of_all = shares.begin() + std::ptrdiff_t(7 * k);
    HeldMotion& motion = held[k];
    std::copy_n(of_all, 3, motion.along.begin());
    std::copy_n(of_all + 3, 3, motion.about.begin());
    if (of_all[6] > 1.0) holding.ties.push_back(motion.member);
    if (first[k] == double(ranks_.rank())) holding.motions.push_back(motion);
  }
}

Holding Conditions::holding(std::span<const double> displacement) const {
  const std::size_t d = std::size_t(points_.dimension);
  Holding holding;
  holding.prescribed.assign(prescribed_.begin(),
                            prescribed_.begin() + std::ptrdiff_t(points_.reference.size()));
  for (std::size_t dof = 0; dof < holding.prescribed.size(); ++dof) {
    if (constraints().dependent()[dof]) holding.prescribed[dof] = 0;
  }
  const auto place = [&](Index row, const Coordinates& at) { return moved(row, at, displacement); };
  for (const Spring& spring : foundations_.springs()) {
    for (std::size_t c = 0; c < d; ++c) {
      const std::size_t dof = std::size_t(spring.point) * d + c;
      if (!(spring.stiffness[c] > 0.0)) continue;
      if (!constraints().dependent()[dof]) {
        holding.prescribed[dof] = 1;
        continue;
      }
      Coordinates axis{};
      axis[c] = 1.0;
      holding.motions.push_back(
          {spring.point, axis, cross(place(spring.point, points_.position(spring.point)), axis)});
    }
  }
  add_held_sums(displacement, holding);
  for (const Slide& slide : made_.slides) {
    const Coordinates at = place(slide.member, points_.position(slide.member));
    const HeldMotion motion{slide.member, slide.direction, cross(at, slide.direction)};
    holding.handles.push_back({slide.dof, motion, true});
  }
  for (const Constraints::RigidSet& set : constraints().rigid_sets()) {
    const bool is_here = !set.members.empty() && points_.owns(set.members.front());
    holding.ties.push_back(is_here ? set.members.front() : -1);
    if (set.members.empty()) continue;  // none on this rank
    for (const Index member : set.members) {
      holding.links.push_back({set.members.front(), member});
    }
    const Coordinates centre = place(set.translation, set.centre);
    for (std::size_t c = 0; c < 3; ++c) {
      Coordinates axis{};
      axis[c] = 1.0;
      const auto hold = [&](std::size_t dof, const HeldMotion& motion) {
        if (prescribed_[dof]) {
          holding.motions.push_back(motion);
        } else {
          holding.handles.push_back({dof, motion});
        }
      };
      const std::size_t turn = std::size_t(set.rotation) * d + (d == 3 ? c : 0);
      if (c < d) {
        hold(std::size_t(set.translation) * d + c,
             {set.members.front(), axis, cross(centre, axis)});
      }
      if (d == 3 || c == 2) hold(turn, {set.members.front(), {}, axis});
    }
  }
  for (int axis = 0; axis < points_.dimension; ++axis) {
    const Index handle = constraints().period_handle(axis);
    for (std::size_t c = 0; handle >= 0 && c < d; ++c) {
      holding.free_jump[std::size_t(axis)][c] = !prescribed_[std::size_t(handle) * d + c];
    }
  }
  return holding;
}

}  // namespace peristat
