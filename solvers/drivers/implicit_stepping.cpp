#include "solvers/drivers/implicit_stepping.hpp"

#include <algorithm>
#include <utility>

#include "assembly/borne_stretches.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

/// A step that fails under a control and is shorter than this fraction of the first is an
/// avalanche.
constexpr double share_of_avalanche = 0.25;

/// Largest number of equilibria in an avalanche.
constexpr int most_passes = 1000;

/// After so many failed searches with growing damage in a row, such a search is tried only in every
/// eighth pass: it takes five times the iterations of one with held damage.
constexpr int most_failures = 4, passes_between_tries = 8;

/// Fraction by which a step may exceed the load at which the first point fails.
constexpr double most_overload = 0.02;

}  // namespace

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
  if (!path_.goes_on()) return Advance::ended;
  FragmentPins pins = path_.state().pins;
  ImplicitStep step = search(path_.setting().newton_options.damage);
  if (step.attempt.has_converged() && refines_preload(step)) return Advance::goes_on;
  if (step.attempt.has_converged() && approach_failure(step)) return Advance::goes_on;
  if (step.attempt.has_converged()) establish(step);
  if (may_be_avalanche(step)) run_avalanche(step);
  if (!step.attempt.has_converged() && path_.state().pins.pinned != pins.pinned &&
      path_.pin_as_before(std::move(pins)) != Advance::goes_on) {
    return Advance::ended;
  }
  return step.attempt.has_converged() ? accept(std::move(step)) : fail(std::move(step));
}

ImplicitStep ImplicitStepping::search(Damage damage) {
  const State& from = path_.state().accepted;
  const LoadPoint target = increment_.next_point(load_point(from));
  ImplicitStep step;
  step.target = target;
  step.attempted = Increment::length(load_point(from), target);
  if (const auto refusal = path_.refusal_of_conditions(target)) {
    step.attempt = undefined_attempt(from, target);
    step.fault = *refusal;
    return step;
  }
  NewtonOptions options = path_.setting().newton_options;
  options.damage = damage;
  step.attempt = path_.search(from, target, options);
  if (step.attempt.outcome == Outcome::undefined_condition) step.fault = step.attempt.note;
  step.hardest = step.attempt.iterations;
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
  if (path_.damaged().model().fails_by_release()) {
    step.found.record.overload = step.growth.utilisation;
  }
  if (step.growth.degrading > 0 || path_.body().assembler.has_friction()) {
    const bool fails_in_avalanches = path_.damaged().model().fails_in_avalanches();
    if (fails_in_avalanches || path_.damaged().model().struts()) {
      step.found.energies.intact = {path_.working_force(attempt.state, attempt.external_force),
                                    attempt.state.displacement};
      step.found.energies.heating =
          heating_work(path_.body().assembler, path_.state().accepted, attempt.state.at());
    }
    commit(path_, attempt, step.found, [&] {
      const State from = state_of(attempt);
      const Outcome pinned = pin_loose(from, step);
      if (pinned != Outcome::converged) return attempt.outcome = pinned;
      step.found.energies.is_avalanche = fails_in_avalanches;
      NewtonOptions again = path_.setting().newton_options;
      again.scale = attempt.scale;
      // A few bonds have lost stiffness: the factor before that still serves iterations.
      again.factorizes_first = !path_.damaged().model().fails_by_release();
      const int before = attempt.iterations;
      const bool unstable_start = attempt.unstable_start;  // of the step, which decides about cuts
      attempt = path_.search(from, load_point(from), again);
      step.hardest = std::max(step.hardest, attempt.iterations);
      attempt.iterations += before;
      attempt.unstable_start = unstable_start;
      return attempt.outcome;
    });
  }
  step.found.record.newton_iterations = attempt.iterations;
  step.fault = complete(path_, attempt, step.found);
}

bool ImplicitStepping::refines_preload(const ImplicitStep& step) {
  const bool damages = path_.is_preloading() && step.growth.degrading > 0;
  if (!damages || !increment_.refine_preload(step.attempted)) return false;
  path_.tell(step.attempt.at,
             {.increment = step.attempted,
              .outcome = name(Outcome::converged),
              .action = Decision::cut,
              .next_increment = increment_.value(),
              .reason = "the loads and displacements at load 0 would damage the body"});
  return true;
}

bool ImplicitStepping::approach_failure(const ImplicitStep& step) {
  const Model& model = path_.damaged().model();
  if (!model.fails_in_avalanches() || (model.failing_bonds() && !fails_by_steps(model))) {
    return false;
  }
  const double after = step.growth.utilisation;
  if (after <= 1.0 + most_overload) return false;
  const double before = path_.damaged().growth(path_.state().accepted).utilisation;
  const double rest = (1.0 + 0.5 * most_overload - before) / (after - before) * step.attempted;
  if (before >= 1.0 || !increment_.can_cut_to(rest)) return false;
  increment_.cut_to(rest);
  path_.tell(step.attempt.at, {.increment = step.attempted,
                               .outcome = name(Outcome::converged),
                               .action = Decision::cut,
                               .next_increment = rest,
                               .reason = "points or bonds would fail at " + number_text(after) +
                                         " of the load that they can bear"});
  return true;
}

Outcome ImplicitStepping::pin_loose(const State& at, ImplicitStep& step) {
  if (!path_.damaged().model().fails_in_avalanches()) {
    return Outcome::converged;  // pinned after acceptance
  }
  FragmentPins& pins = path_.state().pins;
  const FragmentRemedy remedy = path_.options().fragments;
  pins.find(path_.body().assembler, at, path_.setting().conditions, remedy);
  if (!pins.are_outdated(path_.problem().sums())) return Outcome::converged;
  if (remedy == FragmentRemedy::stop && pins.found.count > 0) {
    step.fault = pins.described(path_.problem().sums());
    return Outcome::fragmented;
  }
  step.has_pinned = true;
  return path_.pin() == Advance::goes_on ? Outcome::converged : Outcome::out_of_memory;
}

bool ImplicitStepping::may_be_avalanche(const ImplicitStep& step) const {
  const Outcome outcome = step.attempt.outcome;
  const bool has_failed = outcome == Outcome::iteration_limit || outcome == Outcome::limit_point ||
                          outcome == Outcome::degenerate || outcome == Outcome::no_answer ||
                          outcome == Outcome::not_positive_definite ||
                          outcome == Outcome::inconsistent;
  const LoadSteppingOptions& options = path_.options();
  const bool is_short = !options.adaptive || step.attempted * options.steps <= share_of_avalanche;
  return has_failed && is_short && path_.setting().conditions.control() &&
         path_.damaged().model().has_history();
}

void ImplicitStepping::run_avalanche(ImplicitStep& step) {
  NewtonOptions growing = path_.setting().newton_options, held = growing;
  held.damage = Damage::held;
  Attempt attempt = path_.search(path_.state().accepted, step.target, held);
  step.found = {};
  step.found.energies.is_avalanche = true;
  int passes = 0, failures = 0;
  for (int iterations = attempt.iterations; attempt.has_converged(); ++passes) {
    Assembler& assembler = path_.damaged();
    const Evaluation committed = assembler.commit(attempt.state.displacement, attempt.state.history,
                                                  {}, attempt.state.environment);
    step.found.growth += committed.growth;
    step.found.energies.released += committed.released;
    step.found.energies.struts += committed.growth.strut_energy;
    if (committed.growth.degrading == 0) break;
    if (passes == most_passes) {
      attempt.outcome = Outcome::iteration_limit;
      break;
    }
    const State from = state_of(attempt);
    held.scale = growing.scale = attempt.scale;
    const bool grows = failures < most_failures || passes % passes_between_tries == 0;
    attempt = path_.search(from, step.target, grows ? growing : held);
    iterations += attempt.iterations;
    if (grows && !attempt.has_converged() && attempt.outcome != Outcome::interrupted) {
      ++failures;
      attempt = path_.search(from, step.target, held);
      iterations += attempt.iterations;
    } else if (grows) {
      failures = 0;
    }
    attempt.iterations = iterations;
  }
  step.attempt = std::move(attempt);
  step.fault.clear();
  if (!step.attempt.has_converged()) return name_snap_back(step);
  step.growth = step.found.growth;
  step.avalanche = std::to_string(step.attempt.iterations) + " iterations in " +
                   std::to_string(passes) + " passes at a fixed control, while " +
                   bonds_text(step.growth.breaking) + " broke";
  establish(step);
  name_snap_back(step);
}

/// Renames a failed avalanche: if it reaches no state, or one whose energy does not balance, it is
/// a snap-back, for which the body would have to unload. Outcomes with other causes keep their
/// name.
void ImplicitStepping::name_snap_back(ImplicitStep& step) {
  Attempt& attempt = step.attempt;
  const Outcome outcome = attempt.outcome;
  const bool is_other = outcome == Outcome::converged || outcome == Outcome::interrupted ||
                        outcome == Outcome::out_of_memory || outcome == Outcome::damage_limit ||
                        outcome == Outcome::fragmented || outcome == Outcome::undefined_condition;
  if (is_other || step.found.growth.breaking == 0) return;
  step.fault = "a snap-back: " + bonds_text(step.found.growth.breaking) +
               " broke at a fixed control, and then " +
               (step.fault.empty() ? explanation(outcome) : step.fault);
  attempt.outcome = Outcome::no_answer;
}

Advance ImplicitStepping::accept(ImplicitStep step) {
  const Attempt& attempt = step.attempt;
  // By release a step is as hard as its searches, however many damage and equilibrium take.
  const int effort = path_.damaged().model().fails_by_release() ? step.hardest : attempt.iterations;
  const bool grows = effort <= path_.options().easy_iterations && increment_.grow();
  const bool is_exact = attempt.note.empty();
  const std::string how =
      step.avalanche.empty() ? std::to_string(attempt.iterations) + " iterations" : step.avalanche;
  path_.tell(attempt.at, {.increment = step.attempted,
                          .outcome = name(attempt.outcome),
                          .action = !is_exact ? Decision::accept_at_round_off
                                    : grows   ? Decision::accept_and_grow
                                              : Decision::accept,
                          .next_increment = increment_.value(),
                          .reason = is_exact                 ? how
                                    : step.avalanche.empty() ? attempt.note
                                                             : how + "; " + attempt.note});
  const Advance advance =
      peristat::accept(path_, std::move(step.attempt), std::move(step.found), increment_.value());
  if (step.has_pinned && advance == Advance::goes_on) tell_of_fragments(path_, increment_.value());
  return advance;
}

Advance ImplicitStepping::fail(ImplicitStep step) {
  Attempt& attempt = step.attempt;
  std::string reason = reason_of(step);
  if (cut(path_, increment_, attempt, step.attempted, reason)) return Advance::goes_on;
  if (is_limit_point(attempt)) {
    if (attempt.outcome != Outcome::limit_point) {
      reason = explanation(Outcome::limit_point) + "; the last search ended with: " + reason;
    }
    attempt.outcome = Outcome::limit_point;
  }
  return path_.stop(std::move(attempt), step.attempted, reason);
}

/// True if a step as small as allowed has failed because bonds soften.
bool ImplicitStepping::is_limit_point(const Attempt& attempt) const {
  if (path_.setting().conditions.control()) return false;  // pivots are negative beyond one anyway
  const bool may_soften = path_.body().assembler.model().has_history();
  if (!may_soften || !path_.options().adaptive) return false;
  return attempt.outcome == Outcome::not_positive_definite ||
         attempt.outcome == Outcome::limit_point ||
         (attempt.has_negative_pivots && worth_cutting(attempt) &&
          attempt.outcome != Outcome::damage_limit);
}

}  // namespace peristat
