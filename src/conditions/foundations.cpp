#include "src/conditions/foundations.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "src/conditions/points_of_set.hpp"
#include "src/conditions/traction.hpp"
#include "src/conditions/with_key.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/expression_at_points.hpp"
#include "src/measures/small_algebra.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// A stiffness per component, checked.
Coordinates checked(const Coordinates& stiffness, int dimension, const std::string& key) {
  bool holds = false;
  for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
    if (!(stiffness[c] >= 0.0) || !std::isfinite(stiffness[c])) {
      throw InputError(indexed(key, c), number_text(stiffness[c]), "must be 0 or positive");
    }
    holds |= stiffness[c] > 0.0;
  }
  if (!holds) throw InputError(key, "", "is zero in every component, so it has no effect");
  return stiffness;
}

std::vector<Spring> on_boundary(const Points& points, const FoundationSpecification& of,
                                const std::string& table, const Communicator& ranks) {
  const Coordinates modulus = checked(of.modulus, points.dimension, table + ".modulus");
  LoadSpecification place;
  place.kind = LoadSpecification::Kind::traction;
  place.set = of.set;
  place.side = of.side;
  const TractionAreas areas =
      with_table(table, [&] { return traction_areas(points, place, 0.0, table, ranks); });
  std::vector<Spring> springs;
  for (std::size_t k = 0; k < areas.points.size(); ++k) {
    springs.push_back({areas.points[k], scaled<3>(areas.area[k], modulus)});
  }
  return springs;
}

std::vector<Spring> on_set(const Points& points, const FoundationSpecification& of,
                           const std::string& table, const Communicator& ranks) {
  const Coordinates stiffness = checked(of.stiffness, points.dimension, table + ".stiffness");
  std::vector<Index> members = points_of_set(points, of.set, table + ".set");
  if (points.owned) {  // the owner has a ghost's spring
    std::erase_if(members, [&](Index point) { return point >= *points.owned; });
  }
  double volume = 0.0;
  for (const Index point : members) volume += points.volume[point];
  volume = ranks.sum(volume);
  std::vector<Spring> springs;
  for (const Index point : members) {
    springs.push_back({point, scaled<3>(points.volume[point] / volume, stiffness)});
  }
  return springs;
}

}  // namespace

Foundations::Foundations(const Points& points,
                         const std::vector<FoundationSpecification>& specifications,
                         const std::vector<std::string>& parameters, const Communicator& ranks)
    : dimension_(points.dimension) {
  for (std::size_t k = 0; k < specifications.size(); ++k) {
    const FoundationSpecification& of = specifications[k];
    const std::string table = indexed("foundations", k);
    const bool has_modulus = of.modulus != Coordinates{}, has_total = of.stiffness != Coordinates{};
    if (has_modulus == has_total) {
      throw InputError(table, "", "needs either a modulus or a stiffness");
    }
    const std::vector<Spring> springs =
        has_modulus ? on_boundary(points, of, table, ranks) : on_set(points, of, table, ranks);
    for (std::size_t c = 0; c < 3; ++c) {
      holds_[c] = holds_[c] || of.modulus[c] > 0.0 || of.stiffness[c] > 0.0;
    }
    Foundation made{of.name, table, springs_.size(), springs_.size() + springs.size(), {}};
    for (int c = 0; c < points.dimension; ++c) {
      const std::string key = indexed(table + ".displacement", std::size_t(c));
      made.ground.push_back(with_key(
          key, [&] { return expression_of(of.displacement[std::size_t(c)], points, parameters); }));
    }
    foundations_.push_back(std::move(made));
    springs_.insert(springs_.end(), springs.begin(), springs.end());
    for (const Spring& spring : springs) place_.push_back(points.position(spring.point));
  }
}

std::vector<Foundations::Summary> Foundations::summaries() const {
  std::vector<Summary> all;
  for (const auto& [name, table, first, last, ground] : foundations_) {
    Summary of{name, table + ".name", last - first, {}};
    for (std::size_t k = first; k < last; ++k) {
      of.stiffness = plus<3>(of.stiffness, springs_[k].stiffness);
    }
    all.push_back(std::move(of));
  }
  return all;
}

bool Foundations::ground_moves() const {
  return std::any_of(foundations_.begin(), foundations_.end(), [](const Foundation& foundation) {
    return std::any_of(foundation.ground.begin(), foundation.ground.end(),
                       [](const Expression& ground) { return ground.text() != "0"; });
  });
}

std::vector<double> Foundations::ground(std::span<const double> loads) const {
  const auto d = std::size_t(dimension_);
  std::vector<double> ground(springs_.size() * d);
  std::vector<Index> points;
  for (const Spring& spring : springs_) points.push_back(spring.point);
  for (const auto& [name, table, first, last, displacement] : foundations_) {
    const auto places = std::span(place_).subspan(first, last - first);
    const auto members = std::span(std::as_const(points)).subspan(first, last - first);
    for (std::size_t c = 0; c < d; ++c) {
      const std::vector<double> values = with_key(indexed(table + ".displacement", c), [&] {
        return displacement[c].at(places, loads, members);
      });
      for (std::size_t k = 0; k < values.size(); ++k) ground[(first + k) * d + c] = values[k];
    }
  }
  return ground;
}

void Foundations::add_force(std::span<const double> displacement,
                            const SharedEnvironment& environment, double factor,
                            std::span<double> force) const {
  for_each(displacement, environment, [&](std::size_t dof, double stiffness, double moved) {
    force[dof] -= factor * stiffness * moved;
  });
}

std::map<std::string, Coordinates> Foundations::forces(std::span<const double> displacement,
                                                       const SharedEnvironment& environment) const {
  std::map<std::string, Coordinates> forces;
  for (const Foundation& foundation : foundations_) {
    Coordinates& sum = forces[foundation.name];
    for_each(foundation.first, foundation.last, displacement, environment,
             [&](std::size_t dof, double stiffness, double moved) {
               sum[dof % std::size_t(dimension_)] -= stiffness * moved;
             });
  }
  return forces;
}

}  // namespace peristat
