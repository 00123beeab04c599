#include "solvers/search/condition_rates.hpp"

#include <algorithm>

#include "src/core/input_error.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Step of the differences of conditions; a power of two, so that no digit of the unknown is lost.
constexpr double difference = 0x1p-13;

/// force -= the difference of dE/dx between two load points, both transformed to the independent
/// degrees of freedom.
void take_off_heating(Assembler& assembler, const Conditions& conditions, const StateView& at,
                      const LoadPoint& low, const LoadPoint& high, std::vector<double>& force) {
  StateView there = at;
  there.environment = conditions.environment(high);
  const bool follows = !conditions.constraints().none();
  if (!there.environment && !follows) return;
  std::vector<double> change(force.size());
  if (there.environment) {
    static_cast<void>(assembler.gradient(there, change));
    std::vector<double> gradient(force.size());
    there.environment = conditions.environment(low);
    static_cast<void>(assembler.gradient(there, gradient));
    add_scaled(change, -1.0, gradient);
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
