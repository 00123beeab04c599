#include "solvers/drivers/hand_over.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "src/core/number_text.hpp"

namespace peristat {
namespace {

/// An implicit step that would damage a bond is cut to this fraction of the interpolated length to
/// the onset of damage.
constexpr double share_to_onset = 0.98;

/// A force that falls by a smaller fraction counts as constant.
constexpr double smallest_fall = 1e-9;

/// Relative fall of the force from the last accepted state to a found one. The force is measured by
/// its work on the increment of the displacements.
double fall_of_force(const Path& path, const Attempt& attempt) {
  const std::vector<double>& before = path.state().ledger.force;
  const std::vector<double> after = path.working_force(attempt.state, attempt.external_force);
  const std::vector<double>& from = path.state().accepted.displacement;
  const Sums sums = path.problem().sums();
  double work_before = 0.0, work_after = 0.0;
  sums.for_each_entry(from.size(), [&](std::size_t dof) {
    const double moved = attempt.state.displacement[dof] - from[dof];
    work_before += before[dof] * moved;
    work_after += after[dof] * moved;
  });
  work_before = sums.of_all(work_before);
  work_after = sums.of_all(work_after);
  return work_before > 0.0 ? 1.0 - work_after / work_before : 0.0;
}

/// Text that reports a step in which the force begins to fall.
std::string peak_text(const Path& path, const LoadPoint& at, double fall) {
  const Conditions& conditions = path.setting().conditions;
  return "; the peak of the force lies between the load factors " +
         number_text(conditions.load_factor(load_point(path.state().accepted))) + " and " +
         number_text(conditions.load_factor(at)) + ", between which it falls by " +
         number_text(100.0 * fall) + " %";
}

/// Text that warns of a relaxed step that goes far beyond the load at which damage begins; empty:
/// it does not.
/// @param onset   distance in the stage from the accepted state to the onset of damage
/// @param relaxed length of the relaxed step, likewise
std::string overrun_text(const Path& path, double onset, double relaxed) {
  constexpr double far = 2.0;  // times the load at the onset: no peak can be seen in between
  const double stage = path.state().accepted.stage;
  const double ratio = (stage + relaxed) / (stage + onset);
  if (path.is_preloading() || ratio <= far) return "";
  const Conditions& conditions = path.setting().conditions;
  return "; damage begins at about load factor " +
         number_text(conditions.load_factor(LoadPoint(stage + onset))) +
         ", but the next step goes to " +
         number_text(conditions.load_factor(LoadPoint(stage + relaxed))) +
         ": a peak of the force between them would be missed; give more steps (relaxation.steps) "
         "or a smaller load";
}

/// Largest change of a set's reactions, as a fraction of the largest reaction.
double largest_jump(const std::map<std::string, Coordinates>& before,
                    const std::map<std::string, Coordinates>& after) {
  double jump = 0.0, largest = 0.0;
  for (const auto& [set, reaction] : before) {
    for (std::size_t c = 0; c < reaction.size(); ++c) {
      jump = std::max(jump, std::abs(after.at(set)[c] - reaction[c]));
      largest = std::max(largest, std::abs(reaction[c]));
    }
  }
  return largest > 0.0 ? jump / largest : 0.0;
}

}  // namespace

Advance HandOver::next() {
  if (!path_.goes_on()) return Advance::ended;
  return path_.state().hand_over.relaxes ? relaxed_step() : implicit_step();
}

/// Damage is left to relaxation: what matters is only whether an implicit state would damage a
/// bond.
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
  const double onset = std::min(share, 1.0) * step.attempted;
  const double rest = share_to_onset * onset;
  const std::string why = bonds_text(step.growth.degrading) +
                          " would be damaged, the most stretched to " +
                          std::to_string(step.growth.utilisation) + " of its limit";
  const bool near = rest < relaxed_.increment().value() || state.hand_over.is_near_onset;
  if (near || !implicit_.increment().can_cut_to(rest)) {
    return hand_over(step, why + overrun_text(path_, onset, relaxed_.increment().value()));
  }
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
    double jump = 0.0;
    if (take_up_body(jump) == Advance::ended) return Advance::ended;
    reason +=
        "; the body with the horizon of damage replaces its stand-in: at the same load, reactions "
        "change by " +
        number_text(100.0 * jump) + " %";
  }
  if (path_.is_preloading()) relaxed_.increment().cut_to(relaxed_.increment().value());
  state.hand_over = {.relaxes = true, .is_near_onset = false};
  state.relaxed.motion = {};
  path_.tell(step.attempt.at, {.increment = step.attempted,
                               .outcome = name(step.attempt.outcome),
                               .action = Decision::hand_over,
                               .next_increment = relaxed_.increment().value(),
                               .reason = reason});
  return Advance::goes_on;
}

Advance HandOver::take_up_body(double& jump) {
  PathState& state = path_.state();
  const Conditions& conditions = path_.setting().conditions;
  std::vector<double> force(state.accepted.displacement.size());
  conditions.external_force(load_point(state.accepted), force);
  Trial stand_in;
  stand_in.displacement = state.accepted.displacement;
  stand_in.history = state.accepted.history;
  stand_in.environment = state.accepted.environment;
  evaluate(path_.problem(), force, stand_in, Damage::held);
  const auto before = reactions(path_, stand_in, force);
  state.stands_in = false;
  if (!state.pins.pinned.empty() && path_.analyze() == Advance::ended) {
    return Advance::ended;
  }
  Attempt attempt =
      path_.search(state.accepted, load_point(state.accepted), path_.setting().newton_options);
  if (!attempt.has_converged()) {
    const std::string reason = explanation(attempt.outcome);
    return path_.stop(std::move(attempt), 0.0, reason);
  }
  jump = largest_jump(before, reactions(path_, attempt.state, attempt.external_force));
  state.accepted.displacement = attempt.state.displacement;
  state.ledger.begin(attempt.state, path_.working_force(attempt.state, attempt.external_force));
  return Advance::goes_on;
}

Advance HandOver::relaxed_step() {
  PathState::HandOver& state = path_.state().hand_over;
  if (state.peak_before > 0.0) {
    const double half = 0.5 * (state.peak_before - path_.state().accepted.stage);
    relaxed_.increment().cut_to(std::max(half, path_.options().peak_tolerance));
  }
  RelaxedStepping::Found found = relaxed_.search();
  const Attempt& attempt = found.step.attempt;
  if (!attempt.has_converged()) return relaxed_.fail(std::move(found));
  const bool was_damaged = found.step.found.growth.degrading > 0;
  const bool looks_for_peak = path_.options().peak_tolerance > 0.0 && !path_.is_preloading();
  const double fall = looks_for_peak ? fall_of_force(path_, attempt) : 0.0;
  const bool falls = was_damaged && fall > smallest_fall;
  if (cuts_to_peak(found, falls)) return Advance::goes_on;
  std::string peak;
  if (falls && !state.force_falls) peak = peak_text(path_, attempt.at, fall);
  state.force_falls = falls;
  if (falls || attempt.at.stage >= state.peak_before) state.peak_before = 0.0;
  if (relaxed_.accept(std::move(found), peak) == Advance::ended) return Advance::ended;
  const bool hands_back = path_.options().relaxation.holds && !was_damaged;
  if (hands_back && path_.goes_on()) hand_back();
  return Advance::goes_on;
}

bool HandOver::cuts_to_peak(const RelaxedStepping::Found& found, bool falls) {
  PathState::HandOver& state = path_.state().hand_over;
  const double next = std::max(0.5 * found.attempted, path_.options().peak_tolerance);
  const bool is_shorter = next < found.attempted - LoadingProgramme::tolerance;
  if (!falls || state.force_falls || !is_shorter || !relaxed_.increment().can_cut_to(next)) {
    return false;
  }
  const Attempt& attempt = found.step.attempt;
  state.peak_before = attempt.at.stage;
  path_.tell(attempt.at, {.increment = found.attempted,
                          .outcome = name(attempt.outcome),
                          .action = Decision::cut,
                          .next_increment = next,
                          .reason = "the force falls within this step: searching for its peak"});
  return true;
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
