#include "src/conditions/conditions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/input_error.hpp"

namespace peristat {
namespace {

const std::vector<Index>& points_of(const Points& points, const std::string& set,
                                    const std::string& key) {
  const auto found = points.sets.find(set);
  if (found == points.sets.end()) {
    std::string known;
    for (const auto& [name, members] : points.sets) known += (known.empty() ? "" : ", ") + name;
    throw InputError(key, "\"" + set + "\"", "no set of this name; the sets are " + known);
  }
  if (found->second.empty()) throw InputError(key, "\"" + set + "\"", "the set selects no point");
  return found->second;
}

/// Runs `make` and gives its input errors the key that they concern.
template <class Make>
auto with_key(const std::string& key, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(key, error.value(), error.allowed());
  }
}

std::string indexed(const std::string& table, std::size_t number) {
  return table + "[" + std::to_string(number) + "]";
}

}  // namespace

Conditions::Conditions(const Points& points, const std::vector<SupportSpecification>& supports,
                       const std::vector<LoadSpecification>& loads)
    : points_(points), prescribed_(points.reference.size(), 0) {
  for (std::size_t k = 0; k < supports.size(); ++k) {
    const std::string table = indexed("support", k);
    const std::vector<Index>& members = points_of(points, supports[k].set, table + ".set");
    for (int c = 0; c < points.dimension; ++c) {
      const auto& text = supports[k].displacement[c];
      if (!text) continue;
      prescriptions_.push_back(
          {supports[k].set, &members, c, with_key(table + ".displacement", [&] {
             return Expression(*text, points.dimension, points.spacing,
                               Expression::LoadFactor::allowed);
           })});
      for (Index point : members) prescribed_[std::size_t(point) * points.dimension + c] = 1;
    }
  }
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const std::string table = indexed("load", k);
    const std::vector<Index>& members = points_of(points, loads[k].set, table + ".set");
    const bool total = loads[k].kind == LoadSpecification::Kind::total_force;
    double volume = 1.0;
    if (total) {
      volume = 0.0;
      for (Index point : members) volume += points.volume[point];
    }
    for (int c = 0; c < points.dimension; ++c) {
      loads_.push_back({&members, c,
                        with_key(table + (total ? ".total_force" : ".body_force"),
                                 [&] {
                                   return Expression(loads[k].value[c],
                                                     total ? 0 : points.dimension, points.spacing,
                                                     Expression::LoadFactor::allowed);
                                 }),
                        volume});
    }
  }
  refuse_contradictions();
}

void Conditions::refuse_contradictions() const {
  constexpr double unset = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> value(prescribed_.size());
  std::vector<const Prescription*> by(prescribed_.size(), nullptr);
  for (const double load_factor : {0.0, 0.5, 1.0}) {
    std::fill(value.begin(), value.end(), unset);
    for (const Prescription& prescription : prescriptions_) {
      for (Index point : *prescription.points) {
        const std::size_t dof = std::size_t(point) * points_.dimension + prescription.component;
        const double now = prescription.displacement(points_.position(point), load_factor);
        if (!std::isnan(value[dof]) && value[dof] != now) {
          const Coordinates at = points_.position(point);
          const std::string axis(1, "xyz"[prescription.component]);
          throw InputError("support", "",
                           "the supports of sets " + by[dof]->set + " and " + prescription.set +
                               " contradict each other: at point (" + std::to_string(at[0]) + ", " +
                               std::to_string(at[1]) + ", " + std::to_string(at[2]) +
                               ") m the displacement in " + axis + " is " +
                               std::to_string(value[dof]) + " m by one and " + std::to_string(now) +
                               " m by the other at load factor " + std::to_string(load_factor));
        }
        value[dof] = now;
        by[dof] = &prescription;
      }
    }
  }
}

void Conditions::prescribe(double load_factor, std::span<double> displacement) const {
  for (const Prescription& prescription : prescriptions_) {
    for (Index point : *prescription.points) {
      displacement[std::size_t(point) * points_.dimension + prescription.component] =
          prescription.displacement(points_.position(point), load_factor);
    }
  }
}

void Conditions::external_force(double load_factor, std::span<double> force) const {
  std::fill(force.begin(), force.end(), 0.0);
  for (const Load& load : loads_) {
    for (Index point : *load.points) {
      force[std::size_t(point) * points_.dimension + load.component] +=
          load.value(points_.position(point), load_factor) * points_.volume[point] /
          load.spread_over;
    }
  }
}

std::map<std::string, Coordinates> Conditions::reactions(std::span<const double> gradient,
                                                         std::span<const double> external) const {
  std::map<std::string, Coordinates> sums;
  for (const Prescription& prescription : prescriptions_) {
    double& sum = sums[prescription.set][prescription.component];
    for (Index point : *prescription.points) {
      const std::size_t dof = std::size_t(point) * points_.dimension + prescription.component;
      sum += gradient[dof] - external[dof];
    }
  }
  return sums;
}

}  // namespace peristat
