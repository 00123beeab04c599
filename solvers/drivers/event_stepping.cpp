#include "solvers/drivers/event_stepping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "assembly/terms/contact/face_contact_term.hpp"
#include "assembly/terms/damage.hpp"
#include "assembly/terms/failure/bond_failure.hpp"
#include "solvers/drivers/implicit_stepping.hpp"
#include "solvers/drivers/increment.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/potentials/make_saw_tooth.hpp"

namespace peristat {
namespace {

/// Residuals are measured against no less than this fraction of the largest forces so far: a body
/// that has come apart carries none.
constexpr double share_of_scale = 1e-5;

/// Largest error of the trapezoidal rule, relative to the energy turned over in an elastic step; a
/// step with a larger one is cut.
constexpr double share_of_work = 1e-3;

/// The same relative to all work so far: allowed where little happens.
constexpr double share_of_total = 1e-5;

/// Largest energy that may come from nothing by round-off, relative to the energy turned over.
constexpr double share_from_nothing = 1e-6;

/// Share of a load step within which contacts that close and open are one corner of the path. A
/// bond that is loaded up to the corner may be overloaded for as long.
constexpr double share_of_corner = 0.01;

/// Relative residual at which a body counts as settled: the error of its energy is the square of
/// it.
constexpr double settled_tolerance = 1e-7;
constexpr int most_settling_iterations = 10;

/// Newton iterations within which a body that buckles as bonds break may come to rest.
constexpr int most_iterations_of_a_fall = 200;

/// Largest number of events of one avalanche.
constexpr int most_events = 1'000'000;

/// Error of the trapezoidal rule in the external work that contacts take up, whose forces bend
/// where they close and open: what they store is known exactly [J].
double work_error_of_contacts(Assembler& body, const StateView& from, const StateView& to) {
  if (!body.has_contacts()) return 0.0;
  double error = body.work_of_obstacles(from, to);
  for (const auto& [at, sign] : {std::pair(from, -1.0), std::pair(to, 1.0)}) {
    std::vector<double> force(at.displacement.size()), without(force.size());
    StateView bare = at;
    bare.has_contacts = false;
    error -= sign * (body.gradient(at, force).energy - body.gradient(bare, without).energy);
    for (std::size_t dof = 0; dof < force.size(); ++dof) {
      error += 0.5 * (force[dof] - without[dof]) * (to.displacement[dof] - from.displacement[dof]);
    }
  }
  return error;
}

/// Begin of the segment of the programme that a stage is in.
double segment_begin(double stage) { return LoadingProgramme::next_entry(stage) - 1.0; }

/// The largest utilisation of listed bonds; 0 if there are none.
double largest_of(std::span<const UtilisedBond> most_utilised_first) {
  return most_utilised_first.empty() ? 0.0 : most_utilised_first.front().utilisation;
}

/// True if bonds have softened along a law that this mode replaces by a saw-tooth.
bool has_softened_smoothly(Path& path) {
  const PathState& state = path.state();
  const BondFailure* const bonds = path.damaged().model().failing_bonds();
  if (state.events.count > 0 || !bonds || toothed_strength(bonds->potential()).teeth == 0) {
    return false;
  }
  const std::span<const double> stretches =
      bond_stretches(path.damaged().model(), state.accepted.history);
  return std::any_of(stretches.begin(), stretches.end(), [](double at) { return at > 0.0; });
}

}  // namespace

EventStepping::EventStepping(Path& path) : Driver(path) {
  if (!fails_by_steps(path.damaged().model())) {
    throw InputError("mode", "path",
                     "needs bonds that break by laws that fall in steps (a saw-tooth); set "
                     "BodySpecification::teeth");
  }
  if (has_softened_smoothly(path)) {
    throw InputError(
        "mode", "path",
        "can't continue from a state in which bonds have softened in another mode: mode path "
        "follows a saw-tooth of their law, which gives other forces; start from rest");
  }
}

Advance EventStepping::next() {
  if (!path_.goes_on()) return Advance::ended;
  PathState before = path_.state();
  PathState::Events& events = path_.state().events;
  if (borne_.empty()) {
    borne_ = borne_stretches(path_.damaged().model(), path_.state().accepted.history);
  }
  if (events.at_strength) {
    tells_ = false;  // reported before the state was accepted
    Settled settled = ahead_ ? std::move(*ahead_)
                             : settle(path_.state().accepted, path_.state().ledger,
                                      utilised_near(path_.state().accepted));
    tells_ = true;
    ahead_.reset();
    if (!settled.has_converged()) {
      Step failed;
      failed.attempt = std::move(settled.attempt);
      failed.attempt.outcome = settled.outcome;
      failed.fault = std::move(settled.fault);
      return fail(std::move(failed), std::move(before));
    }
    take_up(std::move(settled));
  }
  Step step = search();
  while (step.attempt.has_converged() && is_above_strength(step)) {
    pass_over(step);
    if (step.attempt.has_converged()) step = search();
  }
  if (step.attempt.has_converged() && step.end == StrengthEnd::inadmissible) {
    step = run_avalanche();
  }
  if (step.attempt.has_converged()) complete(step);
  if (!step.attempt.has_converged()) return fail(std::move(step), std::move(before));
  return accept(std::move(step), std::move(before));
}

NewtonOptions EventStepping::held() const {
  NewtonOptions options = path_.setting().newton_options;
  options.damage = Damage::held;
  options.factorizes_first = false;
  options.counts_pivots = false;
  return options;
}

UpdatedTangent& EventStepping::tangent() {
  const SolvedBody& body = path_.body();
  if (!tangent_) {
    tangent_ = std::make_unique<UpdatedTangent>(path_.problem(), body.solver, body.tangent);
    TangentReference known = path_.state().events.tangent;
    if (!known.at.displacement.empty()) {
      known.at.environment = path_.setting().conditions.environment(load_point(known.at));
      tangent_->become(known);
    }
  }
  return *tangent_;
}

double EventStepping::utilisation(const State& at, std::span<const double> borne) const {
  Assembler& body = path_.damaged();
  return largest_utilisation(body, StateView(at, Damage::held), borne);
}

double EventStepping::least_utilisation() const {
  // Leaves room for the gap that ends the batch. The most utilised bond is at its strength.
  return (1.0 - tie) * (1.0 - std::max(1.5 * path_.options().events.tolerance, 1e-3));
}

std::vector<UtilisedBond> EventStepping::utilised_near(const State& at) const {
  return utilised_bonds(path_.damaged(), StateView(at, Damage::held), borne_, least_utilisation());
}

std::vector<UtilisedBond> EventStepping::batch_of(std::vector<UtilisedBond> all) const {
  const double tolerance = path_.options().events.tolerance;
  const double most = largest_of(all);
  std::size_t count = 1;
  while (count < all.size() && (all[count].utilisation >= (1.0 - tolerance) * most ||
                                all[count - 1].utilisation - all[count].utilisation <= tie)) {
    ++count;
  }
  all.resize(std::min(count, all.size()));
  return all;
}

bool EventStepping::pin(Settled& settled) {
  PathState& state = path_.state();
  const FragmentRemedy remedy = path_.options().fragments;
  state.pins.find(path_.body().assembler, settled.state, path_.setting().conditions, remedy);
  if (!state.pins.are_outdated(path_.problem().sums())) return true;
  if (remedy == FragmentRemedy::stop && state.pins.found.count > 0) {
    settled.outcome = Outcome::fragmented;
    settled.fault = state.pins.described(path_.problem().sums());
    return false;
  }
  const Decision action =
      remedy == FragmentRemedy::remove ? Decision::remove_fragments : Decision::hold_fragments;
  if (tells_) {
    path_.tell(load_point(settled.state), {.outcome = name(Outcome::converged),
                                           .action = action,
                                           .reason = state.pins.described(path_.problem().sums())});
  }
  tangent_.reset();  // the equations have changed
  path_.state().events.tangent = {};
  if (path_.pin() == Advance::goes_on) return true;
  settled.outcome = Outcome::out_of_memory;
  return false;
}

bool EventStepping::asks_for_interrupt() const {
  const auto& interrupted = path_.setting().observer.interrupted;
  return interrupted && interrupted();
}

bool EventStepping::touches(const State& at) const {
  Assembler& body = path_.body().assembler;
  if (!body.has_contacts()) return false;
  StateView view(at, Damage::held);
  view.foreseen = at.displacement;
  return !body.closed_contacts(view).empty();
}

Attempt EventStepping::settle_nearby(const State& at, std::span<const double> borne,
                                     double relative_tolerance) {
  StrengthStep step;
  step.preloads = at.preload < 1.0;
  step.borne = borne;
  step.settles = true;
  step.least_scale = share_of_scale * path_.state().events.largest_scale;
  NewtonOptions options = held();
  options.relative_tolerance = relative_tolerance;
  options.max_iterations = most_settling_iterations;
  // Its iterations are not reported: it only precedes the search for the next state.
  StrengthResult found =
      search_strength(path_.problem(), tangent(), at, step, options,
                      [this](const IterationRecord&) { return asks_for_interrupt(); });
  return to_attempt(std::move(found.newton), load_point(at));
}

Attempt EventStepping::settle_downhill(const State& at, double relative_tolerance) {
  tangent().forget();
  NewtonOptions options = held();
  options.relative_tolerance = relative_tolerance;
  options.max_iterations = std::max(options.max_iterations, most_iterations_of_a_fall);
  const SolvedBody& body = path_.body();
  NewtonResult found =
      newton(path_.problem(), body.solver, body.tangent, at, load_point(at), options,
             [this](const IterationRecord&) { return asks_for_interrupt(); });
  return to_attempt(std::move(found), load_point(at));
}

EventStepping::Settled EventStepping::settle(const State& at, const PathLedger& ledger,
                                             std::vector<UtilisedBond> utilised) {
  Assembler& body = path_.damaged();
  const std::vector<UtilisedBond> batch = batch_of(std::move(utilised));
  BondDrops dropped = drop(body, StateView(at, Damage::held), borne_, batch);
  Settled settled;
  settled.dropping = Index(batch.size());
  settled.breaking = dropped.breaking;
  settled.state = at;
  settled.state.history = body.history_of(dropped.histories, at.history);
  const bool tears = tear_faces(body.model(), settled.state.history);
  settled.borne = std::move(dropped.borne);
  const auto energy = [&](const State& of) {
    return body.energy(StateView(of, Damage::held)).energy;
  };
  // By release bonds lose all that hangs on them.
  const bool is_by_release = body.model().fails_by_release();
  const bool bonds_alone = !tears && (is_by_release || body.model().terms().size() == 1);
  const double lost = bonds_alone ? dropped.energy_lost : energy(at) - energy(settled.state);
  const bool was_bifurcated = tangent().has_negative_pivots();
  const bool is_outdated = is_by_release || tangent().touches();
  is_outdated ? tangent().forget() : tangent().lose(dropped.stiffness);

  const FragmentPins pins_before = path_.state().pins;
  const bool may_go_on = dropped.breaking == 0 || pin(settled);
  settled.pins = std::exchange(path_.state().pins, pins_before);
  settled.attempt = undefined_attempt(at, load_point(at));
  if (!may_go_on) return settled;

  const double tolerance = std::max(held().relative_tolerance, settled_tolerance);
  const auto settles = [&](Attempt attempt) {
    settled.attempt = std::move(attempt);
    settled.outcome = settled.attempt.outcome;
    return settled.has_converged() && book_event(at, ledger, dropped, lost, settled);
  };
  const State& from = settled.state;
  const bool has_settled = !touches(from) && settles(settle_nearby(from, settled.borne, tolerance));
  // A stable body comes to rest in a stable state, however far that is.
  const bool is_lost = has_settled && !was_bifurcated && is_unstable(settled.attempt);
  if ((!has_settled || is_lost) && settled.outcome != Outcome::interrupted &&
      !settles(settle_downhill(from, tolerance))) {
    return settled;
  }
  if (!settled.has_converged()) return settled;
  settled.state = state_of(settled.attempt);
  settled.utilisation = utilisation(settled.state, settled.borne);
  return settled;
}

Attempt EventStepping::settle_anywhere(const State& at, std::span<const double> borne,
                                       double relative_tolerance) {
  if (touches(at)) return settle_downhill(at, relative_tolerance);
  Attempt attempt = settle_nearby(at, borne, relative_tolerance);
  if (attempt.has_converged() || attempt.outcome == Outcome::interrupted) return attempt;
  return settle_downhill(at, relative_tolerance);
}

bool EventStepping::is_unstable(const Attempt& attempt) {
  if (!tangent().has_negative_pivots()) return false;
  // The known pivots are those of a state on the way.
  const LinearOutcome outcome = tangent().refresh(state_of(attempt));
  return outcome != LinearOutcome::solved || tangent().has_negative_pivots();
}

bool EventStepping::book_event(const State& at, const PathLedger& ledger, const BondDrops& dropped,
                               double lost, Settled& settled) const {
  StepEnergies energies;
  energies.released = lost - dropped.energy_lost;
  settled.ledger = ledger;
  const std::vector<double> working =
      path_.working_force(settled.attempt.state, settled.attempt.external_force);
  const double dissipated = ledger.entries.dissipated - ledger.released + dropped.dissipated;
  Ledger after = ledger.with_step(path_.problem().sums(), at.displacement, settled.attempt.state,
                                  working, dissipated, energies);
  settled.batch_work = dropped.dissipated - dropped.energy_lost;
  // What loss sets free beyond what it takes is drained, as in other modes.
  if (path_.damaged().model().fails_by_release())
    settled.batch_work = std::max(settled.batch_work, 0.0);
  after.numerical_work += settled.batch_work;
  const double drained = after.balance_error() - ledger.entries.balance_error();
  const double turned_over = std::abs(lost) + std::abs(after.stored) + std::abs(drained);
  if (drained < -share_from_nothing * turned_over) {
    settled.outcome = Outcome::inconsistent;
    settled.fault =
        number_text(-drained) + " J of energy appear without a source while bonds break";
    return false;
  }
  after.drained += drained;
  settled.ledger.accept(after, working, energies);
  settled.fault.clear();
  return true;
}

void EventStepping::take_up(Settled settled) {
  PathState& state = path_.state();
  state.events.broke_at = path_.setting().conditions.load_factor(load_point(state.accepted));
  state.events.batch_work += settled.batch_work;
  ++state.events.count;
  state.accepted = std::move(settled.state);
  state.ledger = std::move(settled.ledger);
  state.pins = std::move(settled.pins);
  borne_ = std::move(settled.borne);
  path_.last_attempt() = std::move(settled.attempt);
}

StrengthStep EventStepping::strength_step() const {
  const PathState& state = path_.state();
  const double stage = state.accepted.stage, begin = segment_begin(stage), end = begin + 1.0;
  StrengthStep step;
  step.borne = borne_;
  step.least_scale = share_of_scale * state.events.largest_scale;
  step.listed = least_utilisation();
  if (state.events.longest > 0.0) step.longest = state.events.longest;
  if (path_.is_preloading()) {
    step.preloads = true;
    step.range = {0.0, 1.0};
    step.stop = 1.0;
    step.corner = share_of_corner;
    return step;
  }
  step.range = {begin, end};
  step.stop = end;
  const double steps = path_.options().steps;
  step.corner = share_of_corner / steps;
  const double asked_for =
      begin + (std::floor((stage - begin) * steps + LoadingProgramme::tolerance) + 1.0) / steps;
  if (stage >= state.events.top) step.stop = std::min(end, asked_for);
  if (stage < state.events.top) step.stop = state.events.top;
  return step;
}

EventStepping::Step EventStepping::search() {
  const State& from = path_.state().accepted;
  const StrengthStep asked = strength_step();
  Step step;
  const LoadPoint stop = asked.point(asked.stop);
  if (const auto refusal = path_.refusal_of_conditions(stop)) {
    step.attempt = undefined_attempt(from, stop);
    step.fault = *refusal;
    return step;
  }
  StrengthResult found =
      search_strength(path_.problem(), tangent(), from, asked, held(),
                      [this](const IterationRecord& row) { return path_.iterated(row); });
  step.end = found.end;
  step.utilised = std::move(found.utilised);
  const LoadPoint reached = asked.point(found.stage);
  step.attempted = Increment::length(load_point(from), reached);
  step.attempt = to_attempt(std::move(found.newton), reached);
  if (found.turns_at_contact && found.end == StrengthEnd::on_the_way) {
    step.how = std::to_string(step.attempt.iterations) + " iterations; a contact closes or opens";
  }
  return step;
}

EventStepping::Step EventStepping::run_avalanche() {
  PathState& state = path_.state();
  Step step;
  step.end = StrengthEnd::on_the_way;
  int passes = 0;
  if (utilisation(state.accepted, borne_) < share_at_strength * (1.0 - tie)) {
    step.attempt = undefined_attempt(state.accepted, load_point(state.accepted));
    step.fault = "no load is admissible, although no bond is at its strength";
    return step;
  }
  for (;; ++passes) {
    Settled settled = settle(state.accepted, state.ledger, utilised_near(state.accepted));
    step.attempt = settled.attempt;
    step.attempt.outcome = settled.outcome;
    step.fault = settled.fault;
    if (!settled.has_converged()) return step;
    const double utilisation = settled.utilisation;
    take_up(std::move(settled));
    if (utilisation <= share_at_strength + 0.5 * (1.0 - share_at_strength)) break;
    if (passes == most_events) {
      step.attempt.outcome = Outcome::iteration_limit;
      return step;
    }
  }
  step.how = std::to_string(passes + 1) + " events while the load is held";
  // This state is reported, so it needs the full accuracy.
  step.attempt = settle_anywhere(state.accepted, borne_, held().relative_tolerance);
  return step;
}

bool EventStepping::is_above_strength(const Step& step) const {
  return step.end == StrengthEnd::on_the_way &&
         largest_of(*step.utilised) > share_at_strength * (1.0 + tie);
}

void EventStepping::pass_over(Step& step) {
  PathState& state = path_.state();
  const Trial& trial = step.attempt.state;
  StepEnergies energies;
  energies.is_elastic_preload = path_.is_preloading();
  energies.heating = heating_work(path_.body().assembler, state.accepted, trial.at());
  const std::vector<double> working = path_.working_force(trial, step.attempt.external_force);
  Ledger& after = step.found.ledger;
  after =
      state.ledger.with_step(path_.problem().sums(), state.accepted.displacement, trial, working,
                             state.ledger.entries.dissipated - state.ledger.released, energies);
  settle_work(step);
  if (!step.attempt.has_converged()) return;
  state.ledger.accept(after, working, energies);
  state.accepted = state_of(step.attempt);
}

void EventStepping::settle_work(Step& step) const {
  const Ledger& before = path_.state().ledger.entries;
  Ledger& after = step.found.ledger;
  const double of_contacts = work_error_of_contacts(path_.body().assembler,
                                                    StateView(path_.state().accepted, Damage::held),
                                                    step.attempt.state.at(Damage::held));
  after.external_work -= of_contacts;
  const double error = after.balance_error() - before.balance_error();
  const double turned_over =
      std::abs(after.stored - before.stored) + std::abs(after.external_work - before.external_work);
  const double allowed =
      share_of_work * turned_over + share_of_total * std::abs(after.external_work);
  if (std::abs(error) > allowed) {
    step.attempt.outcome = Outcome::sharp_turn;
    step.fault = "the work of the step has an error of " + number_text(std::abs(error)) + " J";
  }
  if (std::abs(of_contacts) > allowed && std::abs(of_contacts) > allowed + explained_work(step)) {
    step.attempt.outcome = Outcome::sharp_turn;
    step.fault = "contacts set free " + number_text(std::abs(of_contacts)) +
                 " J that no work accounts for: the body has jumped";
  }
  after.numerical_work -= error;
}

double EventStepping::explained_work(const Step& step) const {
  const State& from = path_.state().accepted;
  const Trial& to = step.attempt.state;
  double explained =
      std::abs(path_.body().assembler.work_of_obstacles(StateView(from, Damage::held), to.at()));
  const std::vector<double> working = path_.working_force(to, step.attempt.external_force);
  for (std::size_t dof = 0; dof < working.size(); ++dof) {
    explained += 0.5 * std::abs((working[dof] - path_.state().ledger.force[dof]) *
                                (to.displacement[dof] - from.displacement[dof]));
  }
  return explained;
}

void EventStepping::complete(Step& step) {
  FoundStep& found = step.found;
  found.record.mode = Mode::path.name;
  found.record.newton_iterations = step.attempt.iterations;
  if (step.attempt.iterations == 0) tangent().forget();  // complete linearises the tangent then
  step.fault = peristat::complete(path_, step.attempt, found);
  if (!step.attempt.has_converged()) return;
  settle_work(step);
}

void EventStepping::tell_response(const Step& step, StepRecord& record) {
  PathState::Events& events = path_.state().events;
  const double stage = step.attempt.at.stage;
  record.broke_at = events.broke_at;
  record.is_on_response = stage >= events.top;
  if (record.is_on_response) {
    const Ledger& ledger = step.found.ledger;
    const double energy = ledger.stored + ledger.dissipated - events.batch_work -
                          dot(step.attempt.external_force, step.attempt.state.displacement);
    const bool is_held = stage == events.top && path_.state().steps > 0;
    events.released +=
        is_held ? events.response_energy - energy : ledger.drained - events.response_drained;
    events.response_energy = energy;
    events.response_drained = ledger.drained;
    events.top = stage;
  }
  record.released_energy = events.released;
}

Stability EventStepping::stability_of_elastic_body() {
  if (tangent().has_negative_pivots()) return Stability::bifurcated;
  return tangent().tells_pivots() ? Stability::stable : Stability::not_judged;
}

Advance EventStepping::accept(Step step, PathState before) {
  PathState& state = path_.state();
  PathState::Events& events = state.events;
  StepRecord& record = step.found.record;
  const State reached = state_of(step.attempt);
  events.largest_scale = std::max(events.largest_scale, step.attempt.scale);
  events.longest *= path_.options().growth;
  if (events.longest > 1.0) events.longest = 0.0;
  tell_response(step, record);
  // Where contacts press the next search can't use the tangents of this one, and the state's own
  // one tells whether it is stable.
  const bool needs_tangent = tangent().touches() || touches(reached);
  const bool is_known = !needs_tangent || tangent().refresh(reached) == LinearOutcome::solved;
  events.tangent = tangent().reference();
  if (!step.utilised) step.utilised = utilised_near(reached);
  events.at_strength = largest_of(*step.utilised) >= 1.0 - tie;
  std::string how =
      step.how.empty() ? std::to_string(step.attempt.iterations) + " iterations" : step.how;
  record.stability = is_known ? stability_of_elastic_body() : Stability::not_judged;
  if (events.at_strength) {
    PathLedger with_step = state.ledger;
    with_step.accept(step.found.ledger,
                     path_.working_force(step.attempt.state, step.attempt.external_force),
                     step.found.energies);
    ahead_ = settle(reached, with_step, std::move(*step.utilised));
    if (ahead_->outcome == Outcome::interrupted) {  // the state's stability is not known
      step.attempt.outcome = Outcome::interrupted;
      return fail(std::move(step), std::move(before));
    }
    const bool runs_on = !ahead_->has_converged() || ahead_->utilisation > 1.0 + tie;
    if (runs_on && record.stability != Stability::bifurcated) {
      record.stability = Stability::unstable;
    }
    how += "; " + bonds_text(ahead_->dropping) + " at their strength";
  }
  path_.tell(step.attempt.at, {.increment = step.attempted,
                               .outcome = name(step.attempt.outcome),
                               .action = step.attempt.note.empty() ? Decision::accept
                                                                   : Decision::accept_at_round_off,
                               .next_increment = events.longest,
                               .reason = how});
  return peristat::accept(path_, std::move(step.attempt), std::move(step.found), events.longest);
}

Advance EventStepping::fail(Step step, PathState before) {
  Attempt& attempt = step.attempt;
  const std::string reason = reason_of(attempt, step.fault);
  path_.state() = std::move(before);
  path_.state().events.tangent = {};
  ahead_.reset();
  borne_.clear();
  tangent_.reset();
  PathState::Events& events = path_.state().events;
  const double longest = path_.options().cut * std::abs(step.attempted);
  const bool may_cut = path_.options().adaptive && longest >= path_.options().smallest_step &&
                       worth_cutting(attempt);
  if (!may_cut) return path_.stop(std::move(attempt), step.attempted, reason);
  events.longest = longest;
  path_.tell(attempt.at, {.increment = step.attempted,
                          .outcome = name(attempt.outcome),
                          .action = Decision::cut,
                          .next_increment = longest,
                          .reason = reason});
  return Advance::goes_on;
}

}  // namespace peristat
