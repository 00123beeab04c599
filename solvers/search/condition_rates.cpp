#include "solvers/search/condition_rates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "src/core/input_error.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Step of the differences of conditions; a power of two, so that no digit of the unknown is lost.
constexpr double difference = 0x1p-13;

/// Motion of obstacles over which the forces of contacts are differenced, relative to the largest
/// depth of a contact: they are far from linear.
constexpr double share_of_depth = 1e-6;

/// change += the difference of dE/dx that the motion of obstacles from `low` to `high` makes.
void add_motion_of_obstacles(Assembler& assembler, const Obstacles& obstacles, const StateView& at,
                             const SharedEnvironment& low, const SharedEnvironment& high,
                             std::vector<double>& change) {
  if (!obstacles.move()) return;
  std::vector<double> motion = high->obstacles;
  add_scaled(motion, -1.0, low->obstacles);
  double largest = 0.0, shortest = std::numeric_limits<double>::infinity();
  for (const double component : motion) largest = std::max(largest, std::abs(component));
  for (const Obstacles::Obstacle& of : obstacles.all()) {
    for (std::size_t c = of.first; c < of.last; ++c) {
      shortest = std::min(shortest, of.depth * obstacles.contacts()[c].distance);
    }
  }
  if (largest == 0.0) return;
  const double share = std::min(1.0, share_of_depth * shortest / largest);
  const SharedEnvironment middle = between(low, high, 0.5);
  const auto gradient_at = [&](double place) {
    auto moved = std::make_shared<Environment>(*middle);
    add_scaled(moved->obstacles, place * share, motion);
    StateView there = at;
    there.environment = std::move(moved);
    std::vector<double> gradient(change.size());
    static_cast<void>(assembler.gradient(there, gradient));
    return gradient;
  };
  std::vector<double> of_contacts = gradient_at(0.5);
  add_scaled(of_contacts, -1.0, gradient_at(-0.5));
  add_scaled(change, 1.0 / share, of_contacts);
}

/// force -= the difference of dE/dx between two load points, both transformed to the independent
/// degrees of freedom.
void take_off_heating(Assembler& assembler, const Conditions& conditions, const StateView& at,
                      const LoadPoint& low, const LoadPoint& high, std::vector<double>& force) {
  StateView there = at;
  there.has_contacts = false;
  there.environment = conditions.environment(high);
  const bool follows = !conditions.constraints().none();
  if (!there.environment && !follows) return;
  std::vector<double> change(force.size());
  if (there.environment) {
    const SharedEnvironment after = there.environment;
    static_cast<void>(assembler.gradient(there, change));
    std::vector<double> gradient(force.size());
    there.environment = conditions.environment(low);
    static_cast<void>(assembler.gradient(there, gradient));
    add_scaled(change, -1.0, gradient);
    add_motion_of_obstacles(assembler, conditions.obstacles(), at, there.environment, after,
                            change);
  }
  if (follows) conditions.constraints().fold(at.displacement, force, change);
  add_scaled(force, -1.0, change);
}

ConditionRates between(const EquilibriumProblem& problem, const StateView& at,
                       const LoadPath& loads, double low, double high) {
  const Conditions& conditions = problem.conditions;
  const std::size_t dofs = conditions.prescribed().size();
  ConditionRates rates{std::vector<double>(dofs), std::vector<double>(dofs, 0.0)};
  std::vector<double> before(dofs, 0.0);
  conditions.external_force(loads(low), before);
  conditions.external_force(loads(high), rates.force);
  add_scaled(rates.force, -1.0, before);
  take_off_heating(problem.assembler, conditions, at, loads(low), loads(high), rates.force);
  std::fill(before.begin(), before.end(), 0.0);
  conditions.prescribe(loads(low), before);
  conditions.prescribe(loads(high), rates.displacement);
  add_scaled(rates.displacement, -1.0, before);
  if (const auto earlier = conditions.environment(loads(low))) {
    rates.eigenstretch = conditions.environment(loads(high))->eigenstretch;
    if (!earlier->eigenstretch.empty()) add_scaled(rates.eigenstretch, -1.0, earlier->eigenstretch);
  }
  for (auto* const rate : {&rates.force, &rates.displacement, &rates.eigenstretch}) {
    for (double& entry : *rate) entry /= high - low;
  }
  return rates;
}

}  // namespace

ConditionRates rates_of(const EquilibriumProblem& problem, const StateView& at,
                        const LoadPath& loads, double unknown, const LoadRange& range) {
  const double low = std::max(unknown - difference, range.low);
  const double high = std::min(unknown + difference, range.high);
  try {
    return between(problem, at, loads, low, high);
  } catch (const InputError&) {
    try {
      return between(problem, at, loads, unknown, high);
    } catch (const InputError&) {
      return between(problem, at, loads, low, unknown);
    }
  }
}

}  // namespace peristat
