#include "solvers/drivers/attempt.hpp"

#include <utility>

#include "src/core/number_text.hpp"

namespace peristat {
namespace {

/// Members that the results of both kinds of searches have.
template <class Result>
Attempt common_attempt(Result result, const LoadPoint& at) {
  Attempt attempt;
  attempt.outcome = result.outcome;
  attempt.iterations = result.iterations;
  attempt.at = at;
  attempt.scale = result.scale;
  attempt.largest_residual = result.largest_residual;
  attempt.state = std::move(result.state);
  attempt.external_force = std::move(result.external_force);
  return attempt;
}

}  // namespace

Attempt to_attempt(NewtonResult result, const LoadPoint& at) {
  const std::optional<Inertia> inertia = result.inertia;
  const bool negative = result.has_negative_pivots, unstable = result.unstable_start;
  std::string note;
  if (result.is_at_round_off) {
    note = "converged to round-off: the residual is " + number_text(result.state.residual_norm) +
           " N, above the tolerance, but round-off of displacements of this size limits it to " +
           number_text(result.largest_residual) + " N";
  }
  Attempt attempt = common_attempt(std::move(result), at);
  attempt.note = std::move(note);
  attempt.inertia = inertia;
  attempt.has_negative_pivots = negative;
  attempt.unstable_start = unstable;
  return attempt;
}

Attempt to_attempt(RelaxationResult result, const LoadPoint& at) {
  return common_attempt(std::move(result), at);
}

Attempt undefined_attempt(const State& from, const LoadPoint& at) {
  Attempt attempt;
  attempt.outcome = Outcome::undefined_condition;
  attempt.at = at;
  attempt.state.displacement = from.displacement;
  attempt.state.history = from.history;
  attempt.state.environment = from.environment;
  return attempt;
}

State state_of(const Attempt& attempt) {
  return {attempt.state.displacement, attempt.at.stage,  attempt.state.history, attempt.at.load,
          attempt.state.environment,  attempt.at.preload};
}

bool worth_cutting(const Attempt& attempt) {
  const Outcome outcome = attempt.outcome;
  return !attempt.unstable_start && outcome != Outcome::interrupted &&
         outcome != Outcome::out_of_memory && outcome != Outcome::singular_tangent;
}

bool worth_relaxing(const Attempt& attempt) {
  return attempt.outcome != Outcome::interrupted && attempt.outcome != Outcome::out_of_memory &&
         attempt.outcome != Outcome::undefined_condition;
}

std::string reason_of(const Attempt& attempt, const std::string& what) {
  return explanation(attempt.outcome) + (what.empty() ? "" : " (" + what + ")");
}

}  // namespace peristat
