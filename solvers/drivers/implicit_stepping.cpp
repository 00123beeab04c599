#include "solvers/drivers/implicit_stepping.hpp"

#include <utility>

namespace peristat {

std::string bonds_text(Index count) {
  return std::to_string(count) + (count == 1 ? " bond" : " bonds");
}

std::string reason_of(const ImplicitStep& step) {
  std::string reason = reason_of(step.attempt, step.fault);
  const std::optional<Inertia>& inertia = step.attempt.inertia;
  if (inertia && inertia->negative > 0) {
    reason += " (" + std::to_string(inertia->negative) + " negative pivots)";
  }
  return reason;
}

ImplicitStepping::ImplicitStepping(Path& path)
    : Driver(path),
      increment_(path.options().steps, path.options().largest_step,
                 {path.options().adaptive, path.options().smallest_step, path.options().growth},
                 path.state().implicit.increment) {}

Advance ImplicitStepping::next() {
  if (!path_.has_load_left()) return Advance::ended;
  ImplicitStep step = search(path_.setting().newton_options.damage);
  if (step.attempt.has_converged()) establish(step);
  return step.attempt.has_converged() ? accept(std::move(step)) : fail(std::move(step));
}

ImplicitStep ImplicitStepping::search(Damage damage) {
  const State& from = path_.state().accepted;
  const double target = increment_.target(from.stage);
  ImplicitStep step;
  step.attempted = target - from.stage;
  if (const auto refusal = path_.refusal_of_conditions(target)) {
    step.attempt = undefined_attempt(from, target);
    step.fault = *refusal;
    return step;
  }
  NewtonOptions options = path_.setting().newton_options;
  options.damage = damage;
  step.attempt = path_.search(from, target, options);
  if (step.attempt.has_converged()) step.growth = path_.damaged().growth(step.attempt.state.at());
  return step;
}

void ImplicitStepping::establish(ImplicitStep& step) {
  Attempt& attempt = step.attempt;
  const int most_broken = path_.options().max_broken_bonds;
  if (most_broken > 0 && step.growth.breaking > most_broken) {
    attempt.outcome = Outcome::damage_limit;
    step.fault = bonds_text(step.growth.breaking);
    return;
  }
  step.found.record.mode = Mode::newton.name;
  if (step.growth.degrading > 0) {
    commit(path_, attempt, step.found, [&] {
      const State from = state_of(attempt);
      NewtonOptions again = path_.setting().newton_options;
      again.scale = attempt.scale;
      const int before = attempt.iterations;
      attempt = path_.search(from, from.stage, again);
      attempt.iterations += before;
      return attempt.outcome;
    });
  }
  step.found.record.newton_iterations = attempt.iterations;
  step.fault = complete(path_, attempt, step.found);
}

Advance ImplicitStepping::accept(ImplicitStep step) {
  const Attempt& attempt = step.attempt;
  const bool grows = attempt.iterations <= path_.options().easy_iterations && increment_.grow();
  const bool is_exact = attempt.note.empty();
  path_.tell(
      {.stage = attempt.stage,
       .increment = step.attempted,
       .outcome = name(attempt.outcome),
       .action = !is_exact ? Decision::accept_at_round_off
                 : grows   ? Decision::accept_and_grow
                           : Decision::accept,
       .next_increment = increment_.value(),
       .reason = is_exact ? std::to_string(attempt.iterations) + " iterations" : attempt.note});
  return peristat::accept(path_, std::move(step.attempt), std::move(step.found),
                          increment_.value());
}

Advance ImplicitStepping::fail(ImplicitStep step) {
  Attempt& attempt = step.attempt;
  std::string reason = reason_of(step);
  const double next = step.attempted * path_.options().cut;
  if (worth_cutting(attempt) && increment_.can_cut_to(next)) {
    increment_.cut_to(next);
    path_.tell({.stage = attempt.stage,
                .increment = step.attempted,
                .outcome = name(attempt.outcome),
                .action = Decision::cut,
                .next_increment = next,
                .reason = reason});
    return Advance::goes_on;
  }
  if (is_limit_point(attempt)) {
    if (attempt.outcome != Outcome::limit_point) {
      reason = explanation(Outcome::limit_point) + "; the last search ended with: " + reason;
    }
    attempt.outcome = Outcome::limit_point;
  }
  return path_.stop(std::move(attempt), step.attempted, reason);
}

/// Whether a step as small as allowed has failed because bonds soften.
bool ImplicitStepping::is_limit_point(const Attempt& attempt) const {
  const bool may_soften = path_.body().assembler.model().has_history();
  if (!may_soften || !path_.options().adaptive) return false;
  return attempt.outcome == Outcome::not_positive_definite ||
         attempt.outcome == Outcome::limit_point ||
         (attempt.has_negative_pivots && worth_cutting(attempt) &&
          attempt.outcome != Outcome::damage_limit);
}

}  // namespace peristat
