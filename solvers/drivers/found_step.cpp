#include "solvers/drivers/found_step.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "solvers/drivers/step_zero.hpp"
#include "src/core/number_text.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Largest number of commits of one step of a body whose equilibrium moves with them, each of which
/// may damage more bonds. By release they lower the sum of stored and dissipated energy, so that
/// they come to an end: a crack that runs through a body at one load takes many.
constexpr int most_commits = 1000, most_commits_by_release = 100'000;

/// Largest fraction of the loads that may act on pinned pieces that an avalanche has torn off:
/// beyond it the body no longer carries its loads.
constexpr double share_of_lost_load = 0.1;

/// @return a message; empty if the body carries its loads
std::string lost_load(const Path& path, const Attempt& attempt) {
  const std::vector<double>& load = attempt.external_force;
  const Sums sums = path.problem().sums();
  const double whole = sums.norm(load);
  const double pinned = path.state().pins.force(sums, attempt.state, load);
  if (whole == 0.0 || pinned <= share_of_lost_load * whole) return {};
  return number_text(pinned) + " N of the loads of " + number_text(whole) +
         " N act on pieces that have come off, so the body does not carry them";
}

/// Records the largest reaction, and reports if it has fallen so far that the path ends.
void note_force(Path& path, const StepRecord& record) {
  PathState::SupportForce& force = path.state().force;
  force.present = 0.0;
  for (const auto& [set, reaction] : record.reactions) {
    force.present = std::max(force.present, std::hypot(reaction[0], reaction[1], reaction[2]));
  }
  force.largest = std::max(force.largest, force.present);
  force.top = std::max(force.top, record.stage);
  if (!path.has_fallen()) return;
  path.tell(load_point(path.state().accepted),
            {.outcome = name(Outcome::converged),
             .action = Decision::stop,
             .reason = "the largest reaction, " + number_text(force.present) + " N, is below " +
                       number_text(path.options().stop_below) + " of its peak, " +
                       number_text(force.largest) + " N"});
}

/// Reports the accepted state as a row of the history.
void report(Path& path, const Attempt& attempt, FoundStep& found) {
  complete_record(path, attempt, found);
  if (!path.body().assembler.has_potential()) {
    found.record.unbalanced_force = sum_of_internal_forces(path.problem(), attempt.state);
  }
  note_force(path, found.record);
  if (const auto& tell = path.setting().observer.accepted) {
    tell(found.record, {.trial = attempt.state,
                        .external_force = attempt.external_force,
                        .piece = path.state().pins.found.piece,
                        .life = path.state().fatigue.lives.life});
  }
}

}  // namespace

void complete_record(const Path& path, const Attempt& attempt, FoundStep& found) {
  StepRecord& record = found.record;
  record.step = path.state().steps;
  record.stage = attempt.at.stage;
  record.load_factor = path.setting().conditions.load_factor(attempt.at);
  if (const DisplacementControl* control = path.setting().conditions.control()) {
    record.control = control->value(attempt.state.displacement) - path.state().control_at_load_zero;
    if (attempt.inertia) record.negative_pivots = attempt.inertia->negative;
  }
  record.cycles = path.state().fatigue.cycles;
  record.stored_energy = found.ledger.stored;
  record.dissipated_energy = found.ledger.dissipated;
  record.drained_energy = found.ledger.drained;
  record.strut_energy = path.state().ledger.struts;
  record.external_work = found.ledger.external_work;
  record.numerical_work = found.ledger.numerical_work;
  record.balance_error = found.ledger.balance_error();
  record.pin_force =
      path.state().pins.force(path.problem().sums(), attempt.state, attempt.external_force);
  record.reactions = reactions(path, attempt.state, attempt.external_force);
}

std::map<std::string, Coordinates> reactions(const Path& path, const Trial& state,
                                             const std::vector<double>& external_force) {
  std::map<std::string, Coordinates> found = path.setting().conditions.reactions(
      state.gradient, external_force, state.displacement, state.environment, state.history.slips());
  const Sums sums = path.problem().sums();
  for (auto& [set, reaction] : found) {
    const std::vector<double> all =
        sums.of_all(std::vector<double>(reaction.begin(), reaction.end()));
    std::copy(all.begin(), all.end(), reaction.begin());
  }
  return found;
}

void commit(Path& path, Attempt& attempt, FoundStep& found,
            const std::function<Outcome()>& equilibrate) {
  Assembler& assembler = path.body().assembler;
  const Model& model = assembler.model();
  const bool is_by_release = model.fails_by_release();
  const int most = is_by_release ? most_commits_by_release : most_commits;
  for (int pass = 0; pass < most; ++pass) {
    path.tell_commit(attempt);
    const Evaluation committed = assembler.commit(attempt.state.displacement, attempt.state.history,
                                                  {}, attempt.state.environment);
    found.growth += committed.growth;
    found.energies.released += committed.released;
    found.energies.struts += committed.growth.strut_energy;
    attempt.state.stored_energy = committed.energy;
    attempt.state.energy_round_off = committed.round_off;
    if (!committed.moves_equilibrium) return;
    // Damaging by release and solving in turns sets energy free that no bond takes.
    if (is_by_release) found.energies.is_avalanche = true;
    if (equilibrate() != Outcome::converged) return;
  }
  attempt.outcome = Outcome::iteration_limit;
}

std::string complete(Path& path, Attempt& attempt, FoundStep& found) {
  const auto& [assembler, solver, tangent, free] = path.body();
  const PathLedger& ledger = path.state().ledger;
  std::vector<double> damage(std::size_t(assembler.points().count()));
  const DamageState damaged = assembler.assess(attempt.state.history, {}, damage);
  found.record.broken_bonds = damaged.broken_bonds;
  found.energies.is_elastic_preload = path.is_preloading() && found.growth.degrading == 0 &&
                                      assembler.has_potential() && attempt.largest_residual >= 0.0;
  if (!found.energies.intact) {
    found.energies.heating = heating_work(assembler, path.state().accepted, attempt.state.at());
  } else {  // obstacles that a force drives have moved since
    const StateView intact(found.energies.intact->displacement, attempt.state.history, Damage::held,
                           attempt.state.environment);
    found.energies.heating += assembler.work_of_obstacles(intact, attempt.state.at());
  }
  found.ledger =
      ledger.with_step(path.problem().sums(), path.state().accepted.displacement, attempt.state,
                       path.working_force(attempt.state, attempt.external_force),
                       damaged.dissipated_energy, found.energies);
  if (!attempt.has_converged()) return {};
  if (assembler.has_passed(path.state().accepted, attempt.state.at())) {
    attempt.outcome = Outcome::degenerate;
    return "a point has passed through what it was to touch; take shorter steps";
  }
  if (attempt.iterations == 0) {  // no tangent has been needed so far
    tangent.linearise(assembler, attempt.state.at(), 0.0);
  }
  std::string fault =
      find_inconsistency(path.problem(), path.damaged(), tangent,
                         {attempt.state, attempt.external_force, attempt.largest_residual,
                          found.energies.relaxed.has_value(), ledger.entries, found.ledger});
  if (!fault.empty()) {
    attempt.outcome = Outcome::inconsistent;
  } else if (found.energies.is_avalanche) {
    fault = lost_load(path, attempt);
    if (!fault.empty()) attempt.outcome = Outcome::limit_point;
  } else if (!found.energies.relaxed && found.growth.degrading > 0 && assembler.has_potential()) {
    fault = ledger.jump_to(found.ledger);
    if (!fault.empty()) attempt.outcome = Outcome::limit_point;
  }
  return fault;
}

void tell_of_fragments(const Path& path, double next) {
  path.tell(
      load_point(path.state().accepted),
      {.outcome = name(Outcome::converged),
       .action = path.options().fragments == FragmentRemedy::remove ? Decision::remove_fragments
                                                                    : Decision::hold_fragments,
       .next_increment = next,
       .reason = path.state().pins.described(path.problem().sums())});
}

Advance resolve_fragments(Path& path, double next) {
  PathState& state = path.state();
  if (!state.pins.are_outdated(path.problem().sums())) return Advance::goes_on;
  const FragmentRemedy remedy = path.options().fragments;
  if (remedy == FragmentRemedy::stop && state.pins.found.count > 0) {
    Attempt attempt = std::move(path.last_attempt());
    attempt.outcome = Outcome::fragmented;
    return path.stop(std::move(attempt), 0.0, state.pins.described(path.problem().sums()));
  }
  tell_of_fragments(path, next);
  state.relaxed.motion = {};
  return path.pin();
}

bool cut(Path& path, Increment& increment, const Attempt& attempt, double attempted,
         const std::string& reason) {
  const double next = attempted * path.options().cut;
  if (!worth_cutting(attempt) || !increment.can_cut_to(next)) return false;
  increment.cut_to(next);
  path.tell(attempt.at, {.increment = attempted,
                         .outcome = name(attempt.outcome),
                         .action = Decision::cut,
                         .next_increment = next,
                         .reason = reason});
  return true;
}

Advance accept(Path& path, Attempt attempt, FoundStep found, double next) {
  PathState& state = path.state();
  const bool is_step_zero = path.is_preloading() && attempt.at.preload == 1.0;
  if (is_step_zero) begin_programme(path, attempt, found);
  if (!path.is_preloading()) ++state.steps;
  state.accepted = state_of(attempt);
  state.ledger.accept(found.ledger, path.working_force(attempt.state, attempt.external_force),
                      found.energies);
  if (found.growth.breaking > 0) {
    state.pins.find(path.body().assembler, state.accepted, path.setting().conditions,
                    path.options().fragments);
  }
  if (!path.is_preloading()) report(path, attempt, found);
  path.last_attempt() = std::move(attempt);
  return resolve_fragments(path, next);
}

}  // namespace peristat
