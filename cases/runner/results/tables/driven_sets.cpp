#include "cases/runner/results/tables/driven_sets.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "solvers/formulations/formulations.hpp"
#include "src/conditions/loaded_facets.hpp"
#include "src/conditions/traction.hpp"
#include "src/core/expression.hpp"
#include "src/geometry/body_cells.hpp"
#include "src/geometry/expression_at_points.hpp"

namespace peristat {
namespace {

bool is_number_zero(const std::string& text) {
  double value = 1.0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end && value == 0.0;
}

std::string name_of_column(const char* quantity, const Driven& driven) {
  return std::string(quantity) + "_" + "xyz"[driven.component] + ":" + driven.name;
}

/// What is driven, each name and component once; several loads there are one, with all forces.
class DrivenList {
 public:
  void add(Driven driven) {
    const auto known = std::ranges::find_if(made_, [&](const Driven& other) {
      return other.name == driven.name && other.component == driven.component;
    });
    if (known == made_.end()) {
      made_.push_back(std::move(driven));
    } else if (known->load) {
      known->forces.insert(known->forces.end(), driven.forces.begin(), driven.forces.end());
    }
  }
  [[nodiscard]] std::vector<Driven> release() { return std::move(made_); }

 private:
  std::vector<Driven> made_;
};

/// A prescribed displacement; nothing if it is free or the number 0.
void add_prescribed(DrivenList& list, const std::string& set, int component,
                    const std::optional<std::string>& displacement) {
  if (displacement && !is_number_zero(*displacement)) {
    list.add({.name = set, .component = component, .set = set});
  }
}

void add_roller(DrivenList& list, const RollerSpecification& roller, int dimension) {
  if (roller.displacement == "free" || is_number_zero(roller.displacement)) return;
  double squared = 0.0;
  for (const double component : roller.normal) squared += component * component;
  for (int c = 0; c < dimension; ++c) {
    const double along = roller.normal[std::size_t(c)];
    if (along == 0.0) continue;
    Driven driven{.name = roller.name(), .component = c, .set = roller.set};
    if (roller.set.empty()) {  // it holds the sum of what is below it, which its value gives
      driven.value = roller.displacement;
      driven.factor = along / std::sqrt(squared);
      driven.place = roller.at.value_or(Coordinates{});
    }
    list.add(std::move(driven));
  }
}

void add_load(DrivenList& list, const LoadSpecification& load, int dimension, bool is_on_surface) {
  using Kind = LoadSpecification::Kind;
  const std::string name_of = !load.set.empty() ? load.set : load.side ? name(*load.side) : "";
  const bool is_of_surface =
      is_on_surface && (load.kind == Kind::traction || load.kind == Kind::pressure);
  const bool is_followed = load.kind == Kind::pressure;
  if (name_of.empty() || load.kind == Kind::stress || (is_of_surface && load.set.empty())) return;
  if (is_followed && !load.side) return;  // it has no direction
  for (int c = 0; c < dimension; ++c) {
    if (is_followed ? load.side->axis != c : is_number_zero(load.value[std::size_t(c)])) continue;
    Driven driven{.name = name_of, .component = c, .load = &load, .set = load.set};
    if (!is_of_surface && !is_followed) driven.forces = {&load};
    list.add(std::move(driven));
  }
}

/// Outermost points of the side of a load without a set; on a mesh those behind the facets that the
/// load acts on.
std::vector<Index> points_of_side(const Points& points, const LoadSpecification& load,
                                  const Communicator& ranks) {
  if (points.mesh) return facet_areas(points, load, "load").points;
  return BodyCells(points, ranks).outermost(*load.side);
}

}  // namespace

std::vector<Driven> driven_by(const Case& from) {
  DrivenList list;
  for (const SupportSpecification& support : from.supports) {
    for (int c = 0; c < from.dimension; ++c) {
      add_prescribed(list, support.set, c, support.displacement[std::size_t(c)]);
    }
  }
  for (const RigidSetSpecification& set : from.constraints.rigid_sets) {
    for (int c = 0; c < from.dimension; ++c) {
      add_prescribed(list, set.set, c, set.displacement[std::size_t(c)]);
    }
  }
  for (const RollerSpecification& roller : from.constraints.rollers) {
    add_roller(list, roller, from.dimension);
  }
  for (const LinearConstraintSpecification& linear : from.constraints.linear) {
    if (is_number_zero(linear.displacement)) continue;
    list.add({.name = linear.name, .value = linear.displacement});  // its multiplier is reaction_x
  }
  for (const ObstacleSpecification& obstacle : from.obstacles) {
    for (int c = 0; c < from.dimension; ++c) {
      const std::string& displacement = obstacle.displacement[std::size_t(c)];
      if (displacement == "free" || is_number_zero(displacement)) continue;
      list.add({.name = obstacle.name, .component = c, .value = displacement});
    }
  }
  const bool is_on_surface = takes(from, Option::surface_loads);
  for (const LoadSpecification& load : from.loads) {
    add_load(list, load, from.dimension, is_on_surface);
  }
  return list.release();
}

std::vector<ProbeColumns> columns_of(const std::vector<Driven>& driven) {
  std::vector<ProbeColumns> columns;
  for (const Driven& one : driven) {
    columns.push_back({name_of_column("displacement", one), 1, "m",
                       "mean displacement of " + one.name + ", which the case drives"});
    if (one.forces.empty()) continue;
    columns.push_back(
        {name_of_column("force", one), 1, "N", "sum of the loads on the points of " + one.name});
  }
  return columns;
}

DrivenSets::DrivenSets(const Case& from, const Body& body)
    : points_(body.points), ranks_(body.index_map->ranks()) {
  const RecordedPoints recorded(body.points, *body.index_map);
  const auto keep_recorded = [&](std::vector<Index> points) {
    std::erase_if(points, [&](Index point) { return point >= recorded.count(); });
    return points;
  };
  for (Driven& driven : driven_by(from)) {
    Measured measured{.driven = std::move(driven), .points = {}, .loaded = {}};
    const LoadSpecification* const load = measured.driven.load;
    if (!measured.driven.set.empty()) {
      const std::span<const Index> members = recorded.members(measured.driven.set);
      measured.points.assign(members.begin(), members.end());
    } else if (load) {
      measured.points = keep_recorded(points_of_side(body.points, *load, ranks_));
    }
    measured.count = ranks_.sum(double(measured.points.size()));
    for (const LoadSpecification* const force : measured.driven.forces) {
      const std::vector<Index> points =
          force->kind == LoadSpecification::Kind::traction
              ? keep_recorded(
                    traction_areas(body.points, *force, body.setting.horizon, "load", ranks_)
                        .points)
              : measured.points;
      measured.loaded.insert(measured.loaded.end(), points.begin(), points.end());
    }
    std::ranges::sort(measured.loaded);  // loads share points, and columns below a face may meet
    const auto [first, last] = std::ranges::unique(measured.loaded);
    measured.loaded.erase(first, last);
    measured_.push_back(std::move(measured));
  }
}

void DrivenSets::add_values(std::span<const double> displacement,
                            std::span<const double> external_force, const LoadValues& loads,
                            std::map<std::string, std::vector<double>>& values) const {
  const auto sum = [&](std::span<const double> of, const std::vector<Index>& points, int c) {
    double mine = -0.0;  // neutral, even for the sign of 0
    for (const Index point : points) {
      mine += of[std::size_t(point) * std::size_t(points_.dimension) + std::size_t(c)];
    }
    return ranks_.sum(mine);
  };
  for (const auto& [driven, points, count, loaded] : measured_) {
    double mean = 0.0;
    if (!driven.value.empty()) {
      const Expression value(driven.value, points_.dimension, points_.spacing, loads.names,
                             points_.columns, functions_of(points_.functions));
      mean = driven.factor * value(driven.place, loads.values);
    } else if (count > 0.0) {
      mean = sum(displacement, points, driven.component) / count;
    }
    values[name_of_column("displacement", driven)] = {mean};
    if (driven.forces.empty()) continue;
    values[name_of_column("force", driven)] = {sum(external_force, loaded, driven.component)};
  }
}

}  // namespace peristat
