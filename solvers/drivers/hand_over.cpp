#include "solvers/drivers/hand_over.hpp"

#include <algorithm>
#include <utility>

namespace peristat {
namespace {

/// Where an implicit step that would damage a bond is cut to: this share of the interpolated way
/// to the onset of damage.
constexpr double share_to_onset = 0.98;

}  // namespace

Advance HandOver::next() {
  if (!path_.has_load_left()) return Advance::ended;
  return path_.state().hand_over.relaxes ? relaxed_step() : implicit_step();
}

/// Damage is relaxation's: where an implicit state would damage a bond does not matter, but that it
/// would.
Advance HandOver::implicit_step() {
  ImplicitStep step = implicit_.search(Damage::held);
  if (step.attempt.has_converged()) {
    if (step.growth.utilisation > 1.0) return approach_damage(step);
    implicit_.establish(step);
  }
  if (step.attempt.has_converged()) return implicit_.accept(std::move(step));
  const bool may_fail = path_.damaged().model().has_history();
  if (may_fail && worth_relaxing(step.attempt)) return hand_over(step, reason_of(step));
  return implicit_.fail(std::move(step));
}

Advance HandOver::approach_damage(const ImplicitStep& step) {
  PathState& state = path_.state();
  const double before = path_.damaged().growth(state.accepted).utilisation;
  const double share = (1.0 - before) / (step.growth.utilisation - before);
  const double rest = share_to_onset * std::min(share, 1.0) * step.attempted;
  const std::string why = bonds_text(step.growth.degrading) +
                          " would be damaged, the most stretched to " +
                          std::to_string(step.growth.utilisation) + " of what it bears";
  const bool near = rest < relaxed_.increment().value() || state.hand_over.is_near_onset;
  if (near || !implicit_.increment().can_cut_to(rest)) return hand_over(step, why);
  state.hand_over.is_near_onset = true;
  implicit_.increment().cut_to(rest);
  path_.tell(step.attempt.at, {.increment = step.attempted,
                               .outcome = name(Outcome::converged),
                               .action = Decision::cut,
                               .next_increment = rest,
                               .reason = why});
  return Advance::goes_on;
}

Advance HandOver::hand_over(const ImplicitStep& step, std::string reason) {
  PathState& state = path_.state();
  if (state.stands_in) {
    if (take_up_body() == Advance::ended) return Advance::ended;
    reason += "; the body with the horizon of damage takes the place of its stand-in";
  }
  state.hand_over = {.relaxes = true, .is_near_onset = false};
  state.relaxed.motion = {};
  path_.tell(step.attempt.at, {.increment = step.attempted,
                               .outcome = name(step.attempt.outcome),
                               .action = Decision::hand_over,
                               .next_increment = relaxed_.increment().value(),
                               .reason = reason});
  return Advance::goes_on;
}

Advance HandOver::take_up_body() {
  PathState& state = path_.state();
  state.stands_in = false;
  if (!state.pins.pinned.empty() && path_.analyze() == Advance::ended) {
    return Advance::ended;
  }
  Attempt attempt =
      path_.search(state.accepted, state.accepted.stage, path_.setting().newton_options);
  if (!attempt.has_converged()) {
    const std::string reason = explanation(attempt.outcome);
    return path_.stop(std::move(attempt), 0.0, reason);
  }
  state.accepted.displacement = attempt.state.displacement;
  state.ledger.begin(attempt.state, path_.working_force(attempt.state, attempt.external_force));
  return Advance::goes_on;
}

Advance HandOver::relaxed_step() {
  RelaxedStepping::Found found = relaxed_.search();
  if (!found.step.attempt.has_converged()) return relaxed_.fail(std::move(found));
  const bool was_damaged = found.step.found.growth.degrading > 0;
  if (relaxed_.accept(std::move(found)) == Advance::ended) return Advance::ended;
  const bool hands_back = path_.options().relaxation.holds && !was_damaged;
  if (hands_back && path_.has_load_left()) hand_back();
  return Advance::goes_on;
}

void HandOver::hand_back() {
  path_.state().hand_over.relaxes = false;
  implicit_.increment().start_again();
  path_.tell(load_point(path_.state().accepted),
             {.outcome = name(Outcome::converged),
              .action = Decision::hand_back,
              .next_increment = implicit_.increment().value(),
              .reason = "no bond was damaged in the last step, which ended in equilibrium"});
}

}  // namespace peristat
