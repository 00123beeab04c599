#include "src/conditions/conditions.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "src/conditions/points_of_set.hpp"
#include "src/conditions/traction.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/body_cells.hpp"

namespace peristat {
namespace {

/// Runs `make` and gives its input errors the key that they concern.
template <class Make>
auto with_key(const std::string& key, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(key, error.value(), error.allowed());
  }
}

/// Gives input errors that have no key that of the table.
template <class Make>
auto with_table(const std::string& table, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(error.key().empty() ? table : error.key(), error.value(), error.allowed());
  }
}

std::vector<Index> all_points(const Points& points) {
  std::vector<Index> all(std::size_t(points.count()));
  std::iota(all.begin(), all.end(), Index(0));
  return all;
}

/// All points but those of layers.
std::vector<Index> points_of_body(const Points& points) {
  return points.lattice ? BodyCells(points).points() : all_points(points);
}

}  // namespace

Conditions::Conditions(const Points& points, const std::vector<SupportSpecification>& supports,
                       const std::vector<LoadSpecification>& loads, LoadingProgramme programme,
                       const std::vector<ControlTerm>& control, const LoadSetting& setting,
                       const Eigenstrains& eigenstrains)
    : points_(points), programme_(std::move(programme)), prescribed_(points.reference.size(), 0) {
  const std::vector<std::string> parameters = LoadingProgramme::names(programme_.parameters());
  for (std::size_t k = 0; k < supports.size(); ++k) {
    const std::string table = indexed("supports", k);
    const std::vector<Index>& members = points_of_set(points, supports[k].set, table + ".set");
    for (int c = 0; c < points.dimension; ++c) {
      const auto& text = supports[k].displacement[c];
      if (!text) continue;
      const std::string key = indexed(table + ".displacement", std::size_t(c));
      prescriptions_.push_back({key, supports[k].set, &members, c, with_key(key, [&] {
                                  return Expression(*text, points.dimension, points.spacing,
                                                    parameters);
                                })});
      for (Index point : members) prescribed_[std::size_t(point) * points.dimension + c] = 1;
    }
  }
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const std::string table = indexed("loads", k);
    if (loads[k].kind == LoadSpecification::Kind::pressure) {
      add_pressure(loads[k], table);
      continue;
    }
    const auto on = std::make_shared<const Loaded>(loaded(loads[k], setting, table));
    const bool total = loads[k].kind == LoadSpecification::Kind::total_force;
    for (int c = 0; c < points.dimension; ++c) {
      const std::string key = indexed(table + ".value", std::size_t(c));
      loads_.push_back({key, on, c, with_key(key, [&] {
                          return Expression(loads[k].value[c], total ? 0 : points.dimension,
                                            points.spacing, parameters);
                        })});
    }
  }
  add_eigenstrains(eigenstrains, setting);
  if (!control.empty()) control_.emplace(points, control, prescribed_);
  find_shared();
  try_stages();
}

Conditions::Loaded Conditions::loaded(const LoadSpecification& load, const LoadSetting& setting,
                                      const std::string& table) const {
  using Kind = LoadSpecification::Kind;
  if (load.kind == Kind::traction) {
    TractionAreas areas =
        with_table(table, [&] { return traction_areas(points_, load, setting.horizon, table); });
    return {std::move(areas.points), std::move(areas.area)};
  }
  Loaded on;
  const bool is_everywhere = load.kind == Kind::gravity && load.set.empty();
  on.points =
      is_everywhere ? points_of_body(points_) : points_of_set(points_, load.set, table + ".set");
  for (const Index point : on.points) on.amount.push_back(points_.volume[point]);
  if (load.kind == Kind::total_force) {
    on.spread_over = std::accumulate(on.amount.begin(), on.amount.end(), 0.0);
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

void Conditions::add_pressure(const LoadSpecification& load, const std::string& table) {
  const std::size_t first = pressed_.face.size();
  with_table(table, [&] { add_pressed_faces(points_, load, table, pressed_); });
  const std::string key = table + ".value";
  pressures_.push_back({key, first, pressed_.face.size(), with_key(key, [&] {
                          return Expression(load.value[0], points_.dimension, points_.spacing,
                                            LoadingProgramme::names(programme_.parameters()));
                        })});
}

void Conditions::add_eigenstrains(const Eigenstrains& eigenstrains, const LoadSetting& setting) {
  const auto add = [&](const std::string& key, const std::string& text, std::vector<Index> points,
                       std::vector<double> factor) {
    eigenstretches_.push_back({key, std::move(points), std::move(factor), with_key(key, [&] {
                                 return Expression(
                                     text, points_.dimension, points_.spacing,
                                     LoadingProgramme::names(programme_.parameters()));
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
  if (eigenstretches_.empty() && pressures_.empty()) return nullptr;
  const std::vector<double> loads = parameters(at);
  auto made = std::make_shared<Environment>();
  for (const auto& [key, first, last, value] : pressures_) {
    with_key(key, [&] {
      for (std::size_t face = first; face < last; ++face) {
        made->pressure.push_back(value(pressed_.centre[face], loads));
      }
    });
  }
  if (!eigenstretches_.empty()) made->eigenstretch.assign(std::size_t(points_.count()), 0.0);
  for (const auto& [key, points, factor, value] : eigenstretches_) {
    with_key(key, [&] {
      for (std::size_t k = 0; k < points.size(); ++k) {
        const double stretch = factor[k] * value(points_.position(points[k]), loads);
        double& sum = made->eigenstretch[std::size_t(points[k])];
        sum += stretch;
        if (!(sum > -1.0)) {
          throw InputError("", '"' + value.text() + '"',
                           "leaves nothing of the length there was: an eigenstrain of " +
                               number_text(sum) + " at " +
                               place_text(points_.position(points[k]), points_.dimension) +
                               " m; it must be above -1");
        }
      }
    });
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
  std::vector<double> values(prescribed_.size(), 0.0);
  const auto try_at = [&](const LoadPoint& at) {
    prescribe(at, values);
    static_cast<void>(environment(at));
    for (const double value : values) largest_ = std::max(largest_, std::abs(value));
  };
  if (control_) return try_at({0.0, 0.0});  // nobody knows where its loads will go
  const auto try_share = [&](double share) { try_at(share * programme_.end()); };
  // The end first: it tells how large displacements are.
  for (const double share : {1.0, 0.0, 0.5}) try_share(share);
  if (first_.empty()) return;
  // Shares at which hardly any two different expressions agree.
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
                       number_text(first_value) + " m by one and " + number_text(second_value) +
                       " m by the other at load factor " + number_text(load_factor));
}

void Conditions::prescribe(const LoadPoint& at, std::span<double> displacement) const {
  // Two expressions of one value may differ in their last digits: 1e-5*load*3 and 3e-5*load.
  constexpr double same = 1e-12;
  const std::vector<double> loads = parameters(at);
  for (const Prescription& prescription : prescriptions_) {
    with_key(prescription.key, [&] {
      for (Index point : *prescription.points) {
        const double value = prescription.displacement(points_.position(point), loads);
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
}

void Conditions::external_force(const LoadPoint& at, std::span<double> force) const {
  const std::vector<double> loads = parameters(at);
  std::fill(force.begin(), force.end(), 0.0);
  for (const Load& load : loads_) {
    with_key(load.key, [&] {
      const auto& [points, amount, spread_over] = *load.on;
      for (std::size_t k = 0; k < points.size(); ++k) {
        force[std::size_t(points[k]) * points_.dimension + load.component] +=
            load.value(points_.position(points[k]), loads) * amount[k] / spread_over;
      }
    });
  }
}

std::map<std::string, Coordinates> Conditions::reactions(std::span<const double> gradient,
                                                         std::span<const double> external) const {
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
  return sums;
}

}  // namespace peristat
