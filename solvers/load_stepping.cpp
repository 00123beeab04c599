#include "solvers/load_stepping.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "assembly/damage.hpp"
#include "solvers/consistency.hpp"
#include "solvers/fragment_pins.hpp"
#include "solvers/increment.hpp"
#include "solvers/path_ledger.hpp"
#include "solvers/vector_verbs.hpp"
#include "src/input_error.hpp"
#include "src/number_text.hpp"
#include "src/stopwatch.hpp"

namespace peristat {
namespace {

/// Commits of one step of a body with triangles or tetrahedra, each of which may damage more bonds.
constexpr int most_commits = 1000;

/// Newton iterations that may finish a relaxed step: quadratic convergence needs no more.
constexpr int most_finishing_iterations = 8;

/// Where an implicit step that would damage a bond is cut to: this share of the interpolated way
/// to the onset of damage.
constexpr double share_to_onset = 0.98;

/// What searches of both kinds end with.
template <class Result>
Attempt common_attempt(Result result, double load_factor) {
  Attempt attempt;
  attempt.outcome = result.outcome;
  attempt.iterations = result.iterations;
  attempt.load_factor = load_factor;
  attempt.scale = result.scale;
  attempt.largest_residual = result.largest_residual;
  attempt.state = std::move(result.state);
  attempt.external_force = std::move(result.external_force);
  return attempt;
}

Attempt to_attempt(NewtonResult result, double load_factor) {
  const std::optional<Inertia> inertia = result.inertia;
  const bool negative = result.has_negative_pivots, unstable = result.unstable_start;
  std::string note;
  if (result.is_at_round_off) {
    note = "converged to round-off: the residual is " + number_text(result.state.residual_norm) +
           " N, above the tolerance, but displacements of this size are not known better than to " +
           number_text(result.largest_residual) + " N";
  }
  Attempt attempt = common_attempt(std::move(result), load_factor);
  attempt.note = std::move(note);
  attempt.inertia = inertia;
  attempt.has_negative_pivots = negative;
  attempt.unstable_start = unstable;
  return attempt;
}

Attempt to_attempt(RelaxationResult result, double load_factor) {
  return common_attempt(std::move(result), load_factor);
}

State state_of(const Attempt& attempt) {
  return {attempt.state.displacement, attempt.load_factor, attempt.state.history};
}

/// Whether a smaller step can help.
bool worth_cutting(const Attempt& attempt) {
  const Outcome outcome = attempt.outcome;
  return !attempt.unstable_start && outcome != Outcome::interrupted &&
         outcome != Outcome::out_of_memory && outcome != Outcome::singular_tangent;
}

/// Whether relaxation may succeed where an implicit search has failed.
bool worth_relaxing(const Attempt& attempt) {
  return attempt.outcome != Outcome::interrupted && attempt.outcome != Outcome::out_of_memory &&
         attempt.outcome != Outcome::undefined_condition;
}

std::string bonds_text(Index count) {
  return std::to_string(count) + (count == 1 ? " bond" : " bonds");
}

IncrementOptions increment_options(const LoadSteppingOptions& options) {
  return {options.adaptive, options.smallest_step, options.growth};
}

class LoadPath {
 public:
  LoadPath(const SolvedBody& body, const Conditions& conditions, const LoadSteppingOptions& options,
           const NewtonOptions& newton_options, const LoadSteppingObserver& observer,
           const SolvedBody* stand_in)
      : main_(body),
        active_(stand_in ? stand_in : &main_),
        conditions_(conditions),
        options_(options),
        newton_options_(newton_options),
        observer_(observer),
        implicit_(options.steps, options.largest_step, increment_options(options)),
        relaxed_(options.relaxation_steps, 0.0, increment_options(options)),
        relaxes_(options.mode == Mode::relaxation),
        pins_(conditions.prescribed(), body.free, options.fragments),
        ledger_(conditions.prescribed()) {
    Trial reference;  // of a body that need not be free of stress
    reference.displacement.assign(conditions.prescribed().size(), 0.0);
    reference.history = main_.assembler.initial_history();
    std::vector<double> external_force(reference.displacement.size());
    conditions.external_force(0.0, external_force);
    evaluate(problem(), external_force, reference);
    ledger_.begin(reference, external_force);
    result_.state = {reference.displacement, 0.0, reference.history};
  }

  LoadSteppingResult follow() {
    while (1.0 - result_.state.load_factor > load_factor_tolerance) {
      result_.last_attempt = {};  // the vectors of a large body count
      const bool goes_on = relaxes_ ? relaxation_step() : implicit_step();
      if (!goes_on) break;
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] Assembler& assembler() { return active_->assembler; }
  [[nodiscard]] EquilibriumProblem problem() { return {assembler(), conditions_, pins_.free()}; }
  [[nodiscard]] bool is_standing_in() const { return active_ != &main_; }
  [[nodiscard]] int next_step() const { return result_.steps + 1; }

  /// A step that was found and may be accepted.
  struct FoundStep {
    StepRecord record;
    DamageGrowth growth;
    StepEnergies energies;
    Ledger ledger;  // with the step
  };

  /// Whether supports and loads have a value at a load factor; otherwise why not.
  std::optional<std::string> refusal_of_conditions(double load_factor) {
    std::vector<double> values(conditions_.prescribed().size());
    try {
      conditions_.prescribe(load_factor, values);
      conditions_.external_force(load_factor, values);
    } catch (const InputError& error) {
      return observer_.describe ? observer_.describe(error) : error.what();
    }
    return std::nullopt;
  }

  [[nodiscard]] Attempt undefined_attempt(double load_factor) const {
    Attempt attempt;
    attempt.outcome = Outcome::undefined_condition;
    attempt.load_factor = load_factor;
    attempt.state.displacement = result_.state.displacement;
    attempt.state.history = result_.state.history;
    return attempt;
  }

  // ---- Implicit steps

  bool implicit_step() {
    const double load_factor = result_.state.load_factor;
    const double target = implicit_.target(load_factor), attempted = target - load_factor;
    if (const auto refusal = refusal_of_conditions(target)) {
      return implicit_failure(undefined_attempt(target), attempted, *refusal);
    }
    // Damage is relaxation's: where an implicit state would damage a bond does not matter, but that
    // it would.
    NewtonOptions options = newton_options_;
    if (options_.mode == Mode::adaptive) options.damage = Damage::held;
    Attempt attempt = search(result_.state, target, options);
    if (attempt.outcome != Outcome::converged)
      return implicit_failure(std::move(attempt), attempted);

    const DamageGrowth growth = main_.assembler.growth(attempt.state.at());
    if (options_.mode == Mode::adaptive && growth.utilisation > 1.0) {
      return approach_damage(growth, target, attempted);
    }
    if (options_.max_broken_bonds > 0 && growth.breaking > options_.max_broken_bonds) {
      attempt.outcome = Outcome::damage_limit;
      return implicit_failure(std::move(attempt), attempted, bonds_text(growth.breaking));
    }
    FoundStep found;
    found.record.mode = "newton";
    if (growth.degrading > 0) {
      commit(attempt, found, [&] {
        const State from = state_of(attempt);
        NewtonOptions again = newton_options_;
        again.scale = attempt.scale;
        const int before = attempt.iterations;
        attempt = search(from, target, again);
        attempt.iterations += before;
        return attempt.outcome;
      });
    }
    found.record.newton_iterations = attempt.iterations;
    if (const std::string fault = complete(found, attempt); attempt.outcome != Outcome::converged) {
      return implicit_failure(std::move(attempt), attempted, fault);
    }
    const bool grows = attempt.iterations <= options_.easy_iterations && implicit_.grow();
    const bool is_exact = attempt.note.empty();
    tell(target, attempted, attempt.outcome,
         !is_exact ? Decision::accept_at_round_off
         : grows   ? Decision::accept_and_grow
                   : Decision::accept,
         implicit_.value(),
         is_exact ? std::to_string(attempt.iterations) + " iterations" : attempt.note);
    return accept(std::move(found), std::move(attempt));
  }

  /// An implicit step has converged to a state that would damage bonds.
  bool approach_damage(const DamageGrowth& growth, double target, double attempted) {
    const double before = main_.assembler.growth(result_.state).utilisation;
    const double share = (1.0 - before) / (growth.utilisation - before);
    const double rest = share_to_onset * std::min(share, 1.0) * attempted;
    const std::string why = bonds_text(growth.degrading) +
                            " would be damaged, the most stretched " + "to " +
                            std::to_string(growth.utilisation) + " of what it bears";
    const bool near = rest < relaxed_.value() || is_near_onset_;
    if (!near && implicit_.can_cut_to(rest)) {
      is_near_onset_ = true;
      implicit_.cut_to(rest);
      tell(target, attempted, Outcome::converged, Decision::cut, rest, why);
      return true;
    }
    return hand_over(target, attempted, Outcome::converged, why);
  }

  bool implicit_failure(Attempt attempt, double attempted, const std::string& what = {}) {
    const double target = attempt.load_factor;
    std::string reason = explanation(attempt.outcome) + (what.empty() ? "" : " (" + what + ")");
    if (attempt.inertia && attempt.inertia->negative > 0) {
      reason += " (" + std::to_string(attempt.inertia->negative) + " negative pivots)";
    }
    const bool may_fail = main_.assembler.model().has_history();
    if (options_.mode == Mode::adaptive && may_fail && worth_relaxing(attempt)) {
      return hand_over(target, attempted, attempt.outcome, reason);
    }
    const double next = attempted * options_.cut;
    if (worth_cutting(attempt) && implicit_.can_cut_to(next)) {
      implicit_.cut_to(next);
      tell(target, attempted, attempt.outcome, Decision::cut, next, reason);
      return true;
    }
    if (is_limit_point(attempt)) {
      if (attempt.outcome != Outcome::limit_point) {
        reason = explanation(Outcome::limit_point) + "; the last search ended with: " + reason;
      }
      attempt.outcome = Outcome::limit_point;
    }
    return stop(std::move(attempt), attempted, reason);
  }

  /// Whether a step as small as allowed has failed because bonds soften.
  [[nodiscard]] bool is_limit_point(const Attempt& attempt) {
    if (!assembler().model().has_history() || !options_.adaptive) return false;
    return attempt.outcome == Outcome::not_positive_definite ||
           attempt.outcome == Outcome::limit_point ||
           (attempt.has_negative_pivots && worth_cutting(attempt) &&
            attempt.outcome != Outcome::damage_limit);
  }

  Attempt search(const State& from, double target, const NewtonOptions& options) {
    const int step = next_step();
    return to_attempt(newton(problem(), active_->solver, active_->tangent, from, target, options,
                             [&](IterationRecord row) { return told(step, row); }),
                      target);
  }

  bool told(int step, IterationRecord row) {
    row.step = step;
    if (observer_.iteration) observer_.iteration(row);
    return observer_.interrupted && observer_.interrupted();
  }

  // ---- Hand-over

  bool hand_over(double target, double attempted, Outcome outcome, const std::string& why) {
    std::string reason = why;
    if (is_standing_in()) {
      if (!take_up_body()) return false;
      reason += "; the body with the horizon of damage takes the place of its stand-in";
    }
    relaxes_ = true;
    is_near_onset_ = false;
    motion_ = {};
    tell(target, attempted, outcome, Decision::hand_over, relaxed_.value(), reason);
    return true;
  }

  /// Equilibrium of the body itself at the load that its stand-in has reached.
  bool take_up_body() {
    active_ = &main_;
    if (pins_.have_pinned() && !analyze()) return false;
    const double load_factor = result_.state.load_factor;
    Attempt attempt = search(result_.state, load_factor, newton_options_);
    if (attempt.outcome != Outcome::converged) {
      const std::string reason = explanation(attempt.outcome);
      return stop(std::move(attempt), 0.0, reason);
    }
    result_.state.displacement = attempt.state.displacement;
    ledger_.begin(attempt.state, attempt.external_force);
    return true;
  }

  void hand_back() {
    relaxes_ = false;
    implicit_.start_again();
    tell(result_.state.load_factor, 0.0, Outcome::converged, Decision::hand_back, implicit_.value(),
         "no bond was damaged in the last step, which ended in equilibrium");
  }

  // ---- Relaxed steps

  /// A relaxed step on its way: where it is, and its share of the ledger.
  struct RelaxedStep {
    Attempt attempt;
    FoundStep found;
    double scale = 0.0;  // norm that the residual is measured against [N]
  };

  bool relaxation_step() {
    const double load_factor = result_.state.load_factor;
    const double target = relaxed_.target(load_factor), attempted = target - load_factor;
    if (const auto refusal = refusal_of_conditions(target)) {
      return relaxation_failure(undefined_attempt(target), attempted, *refusal);
    }
    const RelaxationMotion motion = motion_;
    const bool with_newton = options_.mode == Mode::adaptive && options_.relaxation.holds;

    RelaxedStep step;
    step.found.record.mode = "relaxation";
    step.found.energies.relaxed.emplace();
    step.attempt.state.displacement = result_.state.displacement;
    step.attempt.state.history = result_.state.history;
    step.attempt.load_factor = load_factor;
    const auto equilibrate = [&] {
      if (with_newton) {
        relax_and_finish(step, target);
      } else {
        relax_towards(step, target, options_.relaxation);
      }
      return step.attempt.outcome;
    };
    if (equilibrate() == Outcome::converged && options_.relaxation.holds) {
      commit(step.attempt, step.found, equilibrate);
    }
    std::string fault;
    if (step.attempt.outcome == Outcome::converged) fault = complete(step.found, step.attempt);
    if (step.attempt.outcome != Outcome::converged) {
      motion_ = motion;
      return relaxation_failure(std::move(step.attempt), attempted, fault);
    }
    return accept_relaxed(std::move(step), attempted);
  }

  /// Relaxes until Newton's method is able to finish.
  void relax_and_finish(RelaxedStep& step, double target) {
    RelaxationOptions options = options_.relaxation;
    const double last = options.relative_tolerance;
    for (double tolerance = options_.newton_takes_over_at;; tolerance *= 1e-2) {
      options.relative_tolerance = std::max(tolerance, last);
      relax_towards(step, target, options);
      if (step.attempt.outcome == Outcome::iteration_limit) {
        // A motion without much stiffness, as of a part that hangs on its last bonds: relaxation
        // hardly sees it, a search with projected tangents does.
        finish(step, newton_options_);
        return;
      }
      const bool goes_on = step.attempt.outcome == Outcome::converged && tolerance > last;
      if (!goes_on || finish(step, finishing_options())) return;
    }
  }

  void relax_towards(RelaxedStep& step, double target, RelaxationOptions options) {
    const int number = next_step();
    const State from = state_of(step.attempt);
    if (from.load_factor == target && options.holds) options.ramp = 1;
    options.scale = step.scale;
    const Stopwatch watch(result_.relaxation_seconds);
    RelaxationResult relaxed = relax(problem(), active_->tangent, from, target, options, motion_,
                                     [&](IterationRecord row) { return told(number, row); });
    step.found.record.relaxation_iterations += relaxed.iterations;
    step.found.record.settled = relaxed.largest_residual < 0.0;
    step.found.energies.relaxed->work += relaxed.external_work;
    step.found.energies.relaxed->drained += relaxed.drained_energy;
    step.found.growth.degrading += relaxed.growth.degrading;
    step.found.growth.breaking += relaxed.growth.breaking;
    step.found.energies.released += relaxed.released_energy;
    step.scale = relaxed.scale;
    step.attempt = to_attempt(std::move(relaxed), target);
  }

  /// Only a stable equilibrium close by is taken; anything else is left to relaxation.
  [[nodiscard]] NewtonOptions finishing_options() const {
    NewtonOptions options = newton_options_;
    options.projection = Projection::never;
    options.factorizes_first = false;
    options.counts_pivots = false;
    options.max_iterations = std::min(options.max_iterations, most_finishing_iterations);
    return options;
  }

  /// Newton's last iterations at the fixed load.
  /// @return false if relaxation has to go on
  bool finish(RelaxedStep& step, NewtonOptions options) {
    options.scale = step.scale;
    const State near = state_of(step.attempt);
    Attempt finished = search(near, near.load_factor, options);
    if (finished.outcome != Outcome::converged && worth_relaxing(finished)) return false;
    step.found.record.newton_iterations += finished.iterations;
    if (finished.outcome == Outcome::converged) {
      step.found.record.settled = false;
      step.found.energies.relaxed->drained +=
          step.attempt.state.total_energy - finished.state.total_energy;
      step.found.energies.relaxed->work +=
          dot(finished.external_force, finished.state.displacement) -
          dot(finished.external_force, near.displacement);
    }
    step.attempt = std::move(finished);
    return true;
  }

  bool relaxation_failure(Attempt attempt, double attempted, const std::string& what = {}) {
    const double next = attempted * options_.cut;
    const std::string reason =
        explanation(attempt.outcome) + (what.empty() ? "" : " (" + what + ")");
    if (worth_cutting(attempt) && relaxed_.can_cut_to(next)) {
      relaxed_.cut_to(next);
      tell(attempt.load_factor, attempted, attempt.outcome, Decision::cut, next, reason);
      return true;
    }
    return stop(std::move(attempt), attempted, reason);
  }

  bool accept_relaxed(RelaxedStep step, double attempted) {
    const bool grew = relaxed_.grow();
    const bool was_damaged = step.found.growth.degrading > 0;
    tell(step.attempt.load_factor, attempted, step.attempt.outcome,
         grew ? Decision::accept_and_grow : Decision::accept, relaxed_.value(),
         std::to_string(step.found.record.relaxation_iterations) + " iterations of relaxation");
    if (!accept(std::move(step.found), std::move(step.attempt))) return false;
    const bool hands_back =
        options_.mode == Mode::adaptive && options_.relaxation.holds && !was_damaged;
    if (hands_back && 1.0 - result_.state.load_factor > load_factor_tolerance) hand_back();
    return true;
  }

  // ---- What follows a search

  void tell(double load_factor, double increment, Outcome outcome, Decision action, double next,
            const std::string& reason) {
    if (!observer_.decision) return;
    DecisionRecord decision;
    decision.step = next_step();
    decision.load_factor = load_factor;
    decision.increment = increment;
    decision.outcome = name(outcome);
    decision.action = action;
    decision.next_increment = next;
    decision.reason = reason;
    observer_.decision(decision);
  }

  /// Of the state that a search has ended in, for what is told of it.
  void count_pivots(Attempt& attempt) {
    active_->tangent.linearise(assembler(), attempt.state.at(), 0.0);
    active_->solver.count_pivots(true);
    static_cast<void>(active_->solver.factorize(active_->tangent, FactorUse::factorize_now));
    attempt.inertia = active_->solver.inertia();
  }

  bool stop(Attempt attempt, double attempted, const std::string& reason) {
    if (!attempt.inertia && attempt.has_negative_pivots) count_pivots(attempt);
    tell(attempt.load_factor, attempted, attempt.outcome, Decision::stop, 0.0, reason);
    result_.outcome = attempt.outcome;
    result_.last_attempt = std::move(attempt);
    return false;
  }

  /// Commits an equilibrium. Triangles and tetrahedra then lose what their bonds have lost, so that
  /// the body is out of equilibrium again: it is equilibrated at the fixed load and committed until
  /// nothing more is damaged.
  /// @param equilibrate leaves the next equilibrium in `attempt`, and its outcome
  template <class Equilibrate>
  void commit(Attempt& attempt, FoundStep& found, const Equilibrate& equilibrate) {
    for (int pass = 0; pass < most_commits; ++pass) {
      const Stored committed =
          assembler().commit(attempt.state.displacement, attempt.state.history);
      found.growth.degrading += committed.growth.degrading;
      found.growth.breaking += committed.growth.breaking;
      found.energies.released += committed.released;
      attempt.state.stored_energy = committed.energy;
      if (committed.growth.degrading == 0 || assembler().model().has_only_bonds()) return;
      if (equilibrate() != Outcome::converged) return;
    }
    attempt.outcome = Outcome::iteration_limit;
  }

  /// Closes the ledger of a step whose damage is committed, and checks what it owes.
  /// @return what is wrong with it; the attempt's outcome is then inconsistent
  std::string complete(FoundStep& found, Attempt& attempt) {
    const Assembler& assembler = active_->assembler;
    std::vector<double> damage(std::size_t(assembler.points().count()));
    const DamageState damaged = assess_damage(assembler.model(), attempt.state.history, {}, damage);
    found.record.broken_bonds = damaged.broken_bonds;
    found.ledger =
        ledger_.with_step(result_.state.displacement, attempt.state, attempt.external_force,
                          damaged.dissipated_energy, found.energies);
    if (attempt.outcome != Outcome::converged) return {};
    if (attempt.iterations == 0) {  // no tangent was needed so far
      active_->tangent.linearise(active_->assembler, attempt.state.at(), 0.0);
    }
    std::string fault =
        find_inconsistency(problem(), main_.assembler, active_->tangent,
                           {attempt.state, attempt.external_force, attempt.largest_residual,
                            found.energies.relaxed.has_value(), ledger_.entries(), found.ledger});
    if (!fault.empty()) {
      attempt.outcome = Outcome::inconsistent;
    } else if (!found.energies.relaxed && found.growth.degrading > 0) {
      fault = ledger_.jump_to(found.ledger);
      if (!fault.empty()) attempt.outcome = Outcome::limit_point;
    }
    return fault;
  }

  /// Finds what has come off and tells the step.
  bool accept(FoundStep found, Attempt attempt) {
    result_.state = state_of(attempt);
    ++result_.steps;
    is_near_onset_ = is_near_onset_ && !relaxes_;
    ledger_.accept(found.ledger, attempt.state, attempt.external_force, found.energies);
    if (found.growth.breaking > 0) pins_.find(assembler(), result_.state);

    StepRecord& record = found.record;
    record.step = result_.steps;
    record.load_factor = attempt.load_factor;
    record.stored_energy = found.ledger.stored;
    record.dissipated_energy = found.ledger.dissipated;
    record.drained_energy = found.ledger.drained;
    record.external_work = found.ledger.external_work;
    record.numerical_work = found.ledger.numerical_work;
    record.balance_error = found.ledger.balance_error();
    record.pin_force = pins_.force(attempt.state, attempt.external_force);
    record.reactions = conditions_.reactions(attempt.state.gradient, attempt.external_force);
    if (observer_.accepted) {
      observer_.accepted(record, {attempt.state, attempt.external_force, pins_.piece()});
    }
    result_.last_attempt = std::move(attempt);
    return resolve_fragments();
  }

  // ---- Fragments

  /// Pins what has come free.
  bool resolve_fragments() {
    if (!pins_.are_outdated()) return true;
    if (pins_.shall_stop()) {
      Attempt attempt = std::move(result_.last_attempt);
      attempt.outcome = Outcome::fragmented;
      return stop(std::move(attempt), 0.0, pins_.described());
    }
    pins_.pin();
    tell(result_.state.load_factor, 0.0, Outcome::converged,
         pins_.removes_pieces() ? Decision::remove_fragments : Decision::hold_fragments,
         relaxes_ ? relaxed_.value() : implicit_.value(), pins_.described());
    motion_ = {};
    return analyze();
  }

  /// Prepares the solver for other free degrees of freedom.
  bool analyze() {
    if (active_->solver.analyze(active_->tangent.pattern, pins_.free()) == LinearOutcome::solved) {
      return true;
    }
    Attempt attempt = std::move(result_.last_attempt);
    attempt.outcome = Outcome::out_of_memory;
    return stop(std::move(attempt), 0.0, explanation(Outcome::out_of_memory));
  }

  SolvedBody main_;
  const SolvedBody* active_;
  const Conditions& conditions_;
  const LoadSteppingOptions& options_;
  const NewtonOptions& newton_options_;
  const LoadSteppingObserver& observer_;
  Increment implicit_, relaxed_;
  bool relaxes_;
  bool is_near_onset_ = false;  // an implicit step was cut to end just before damage begins
  FragmentPins pins_;
  RelaxationMotion motion_;
  PathLedger ledger_;
  LoadSteppingResult result_;
};

}  // namespace

LoadSteppingResult follow_loading(const SolvedBody& body, const Conditions& conditions,
                                  const LoadSteppingOptions& options,
                                  const NewtonOptions& newton_options,
                                  const LoadSteppingObserver& observer,
                                  const SolvedBody* stand_in) {
  return LoadPath(body, conditions, options, newton_options, observer, stand_in).follow();
}

}  // namespace peristat
