#include "solvers/load_stepping.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "assembly/damage.hpp"
#include "solvers/consistency.hpp"
#include "solvers/vector_verbs.hpp"
#include "src/conditions/fragments.hpp"
#include "src/input_error.hpp"
#include "src/number_text.hpp"
#include "src/stopwatch.hpp"

namespace peristat {
namespace {

/// Share of the body's energy whose release in an implicit step is a jump over a limit point.
constexpr double share_of_jump = 5e-3;

/// A remainder of the load factor below this is round-off of the sum of steps.
constexpr double end_tolerance = 1e-9;

/// Commits of one step of a body with triangles or tetrahedra, each of which may damage more bonds.
constexpr int most_commits = 1000;

/// Newton iterations that may finish a relaxed step: quadratic convergence needs no more.
constexpr int most_finishing_iterations = 8;

/// Where an implicit step that would damage a bond is cut to: this share of the interpolated way
/// to the onset of damage.
constexpr double share_to_onset = 0.98;

/// Forces that do work on the body: loads, and on prescribed degrees of freedom what holds them,
/// which is dE/dx there. Pins of fragments do none: they don't move, and when they are taken away
/// nothing follows them.
std::vector<double> working_force(const std::vector<char>& prescribed,
                                  const std::vector<double>& external_force,
                                  const std::vector<double>& gradient) {
  std::vector<double> force = external_force;
  for (std::size_t dof = 0; dof < force.size(); ++dof) {
    if (prescribed[dof]) force[dof] = gradient[dof];
  }
  return force;
}

double trapezoidal_work(const std::vector<double>& force0, const std::vector<double>& force1,
                        const std::vector<double>& u0, const std::vector<double>& u1) {
  double work = 0.0;
  for (std::size_t k = 0; k < u0.size(); ++k)
    work += 0.5 * (force0[k] + force1[k]) * (u1[k] - u0[k]);
  return work;
}

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

/// What is left of the load, and how large a step of it is taken next.
class Increment {
 public:
  Increment(int steps, double largest, const LoadSteppingOptions& options)
      : options_(options),
        largest_(largest > 0.0 ? largest : 1.0 / steps),
        first_(std::min(1.0 / steps, largest_)),
        value_(first_) {}

  [[nodiscard]] double value() const { return value_; }

  /// Target of the next step; the last one is not left a remainder of round-off.
  [[nodiscard]] double target(double load_factor) const {
    const double rest = 1.0 - load_factor;
    return rest - value_ > end_tolerance ? load_factor + value_ : 1.0;
  }

  [[nodiscard]] bool can_cut_to(double increment) const {
    return options_.adaptive && increment >= options_.smallest_step;
  }
  void cut_to(double increment) { value_ = increment; }
  /// @return whether it grew
  bool grow() {
    if (!options_.adaptive || value_ >= largest_) return false;
    value_ = std::min(options_.growth * value_, largest_);
    return true;
  }
  void start_again() { value_ = first_; }

 private:
  const LoadSteppingOptions& options_;
  double largest_, first_, value_;
};

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
        implicit_(options.steps, options.largest_step, options),
        relaxed_(options.relaxation_steps, 0.0, options),
        relaxes_(options.mode == Mode::relaxation),
        pinned_(conditions.prescribed().size(), 0),
        free_(&body.free) {
    const std::size_t dofs = pinned_.size();
    result_.state.displacement.assign(dofs, 0.0);
    result_.state.history = main_.assembler.initial_history();
    std::vector<double> gradient(dofs), external_force(dofs);
    conditions.external_force(0.0, external_force);
    const Stored reference = assembler().gradient(result_.state, gradient);
    force_ = working_force(conditions_.prescribed(), external_force, gradient);
    // Of a body that is not free of stress in the reference.
    ledger_.external_work = ledger_.stored = reference.energy;
  }

  LoadSteppingResult follow() {
    while (1.0 - result_.state.load_factor > end_tolerance) {
      result_.last_attempt = {};  // the vectors of a large body count
      const bool goes_on = relaxes_ ? relaxation_step() : implicit_step();
      if (!goes_on) break;
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] Assembler& assembler() { return active_->assembler; }
  [[nodiscard]] EquilibriumProblem problem() { return {assembler(), conditions_, *free_}; }
  [[nodiscard]] bool is_standing_in() const { return active_ != &main_; }
  [[nodiscard]] int next_step() const { return result_.steps + 1; }

  /// A step that was found and may be accepted.
  struct FoundStep {
    StepRecord record;
    DamageGrowth growth;
    double released = 0.0;  // see Stored::released
    struct Relaxed {
      double work = 0.0, drained = 0.0;  // summed over the iterations [J]
    };
    std::optional<Relaxed> relaxed;
    Ledger ledger;  // with the step
  };

  /// Whether supports and loads have a value at a load factor; otherwise why not.
  std::optional<std::string> refusal_of_conditions(double load_factor) {
    std::vector<double> values(pinned_.size());
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
         !is_exact ? "accept at round-off"
         : grows   ? "accept and grow"
                   : "accept",
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
      tell(target, attempted, Outcome::converged, "cut", rest, why);
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
      tell(target, attempted, attempt.outcome, "cut", next, reason);
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
    tell(target, attempted, outcome, "hand over to relaxation", relaxed_.value(), reason);
    return true;
  }

  /// Equilibrium of the body itself at the load that its stand-in has reached.
  bool take_up_body() {
    active_ = &main_;
    if (!pieces_.pinned.empty() && !analyze()) return false;
    const double load_factor = result_.state.load_factor;
    Attempt attempt = search(result_.state, load_factor, newton_options_);
    if (attempt.outcome != Outcome::converged) {
      const std::string reason = explanation(attempt.outcome);
      return stop(std::move(attempt), 0.0, reason);
    }
    result_.state.displacement = attempt.state.displacement;
    force_ =
        working_force(conditions_.prescribed(), attempt.external_force, attempt.state.gradient);
    ledger_ = {};
    ledger_.external_work = ledger_.stored = attempt.state.stored_energy;
    return true;
  }

  void hand_back() {
    relaxes_ = false;
    implicit_.start_again();
    tell(result_.state.load_factor, 0.0, Outcome::converged, "hand back to newton",
         implicit_.value(), "no bond was damaged in the last step, which ended in equilibrium");
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
    step.found.relaxed.emplace();
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
    step.found.relaxed->work += relaxed.external_work;
    step.found.relaxed->drained += relaxed.drained_energy;
    step.found.growth.degrading += relaxed.growth.degrading;
    step.found.growth.breaking += relaxed.growth.breaking;
    step.found.released += relaxed.released_energy;
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
      step.found.relaxed->drained += step.attempt.state.total_energy - finished.state.total_energy;
      step.found.relaxed->work += dot(finished.external_force, finished.state.displacement) -
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
      tell(attempt.load_factor, attempted, attempt.outcome, "cut", next, reason);
      return true;
    }
    return stop(std::move(attempt), attempted, reason);
  }

  bool accept_relaxed(RelaxedStep step, double attempted) {
    const bool grew = relaxed_.grow();
    const bool was_damaged = step.found.growth.degrading > 0;
    tell(step.attempt.load_factor, attempted, step.attempt.outcome,
         grew ? "accept and grow" : "accept", relaxed_.value(),
         std::to_string(step.found.record.relaxation_iterations) + " iterations of relaxation");
    if (!accept(std::move(step.found), std::move(step.attempt))) return false;
    const bool hands_back =
        options_.mode == Mode::adaptive && options_.relaxation.holds && !was_damaged;
    if (hands_back && 1.0 - result_.state.load_factor > end_tolerance) hand_back();
    return true;
  }

  // ---- What follows a search

  void tell(double load_factor, double increment, Outcome outcome, const std::string& action,
            double next, const std::string& reason) {
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
    tell(attempt.load_factor, attempted, attempt.outcome, "stop", 0.0, reason);
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
      found.released += committed.released;
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
    const double work = trapezoidal_work(
        force_,
        working_force(conditions_.prescribed(), attempt.external_force, attempt.state.gradient),
        result_.state.displacement, attempt.state.displacement);
    found.ledger = ledger_;
    found.ledger.stored = attempt.state.stored_energy;
    found.ledger.dissipated = damaged.dissipated_energy + released_energy_ + found.released;
    found.ledger.external_work += work;
    if (found.relaxed) {
      found.ledger.numerical_work += found.relaxed->work - work;
      found.ledger.drained += found.relaxed->drained;
    }
    if (attempt.outcome != Outcome::converged) return {};
    if (attempt.iterations == 0) {  // no tangent was needed so far
      active_->tangent.linearise(active_->assembler, attempt.state.at(), 0.0);
    }
    std::string fault =
        find_inconsistency(problem(), main_.assembler, active_->tangent,
                           {attempt.state, attempt.external_force, attempt.largest_residual,
                            found.relaxed.has_value(), ledger_, found.ledger});
    if (!fault.empty()) {
      attempt.outcome = Outcome::inconsistent;
    } else if (!found.relaxed && found.growth.degrading > 0) {
      fault = has_jumped(found.ledger);
      if (!fault.empty()) attempt.outcome = Outcome::limit_point;
    }
    return fault;
  }

  /// Whether an implicit step in which damage grew has released what nobody takes up. A stable path
  /// balances, but for the little that single bonds release as they snap; beyond a limit point the
  /// search lands where its steps happen to lead.
  [[nodiscard]] std::string has_jumped(const Ledger& after) const {
    const double released = after.balance_error() - ledger_.balance_error();
    if (released <= share_of_jump * std::max(ledger_.stored, after.external_work)) return {};
    return number_text(released) + " J of " + number_text(after.external_work) +
           " J are released and taken up by nobody: the body has jumped to another equilibrium";
  }

  /// Finds what has come off and tells the step.
  bool accept(FoundStep found, Attempt attempt) {
    result_.state = state_of(attempt);
    ++result_.steps;
    is_near_onset_ = is_near_onset_ && !relaxes_;
    force_ =
        working_force(conditions_.prescribed(), attempt.external_force, attempt.state.gradient);
    ledger_ = found.ledger;
    released_energy_ += found.released;
    if (found.growth.breaking > 0) find_pieces();

    StepRecord& record = found.record;
    record.step = result_.steps;
    record.load_factor = attempt.load_factor;
    record.stored_energy = ledger_.stored;
    record.dissipated_energy = ledger_.dissipated;
    record.drained_energy = ledger_.drained;
    record.external_work = ledger_.external_work;
    record.numerical_work = ledger_.numerical_work;
    record.balance_error = ledger_.balance_error();
    record.pin_force = pin_force(attempt);
    record.reactions = conditions_.reactions(attempt.state.gradient, attempt.external_force);
    if (observer_.accepted) {
      observer_.accepted(record, {attempt.state, attempt.external_force, pieces_.piece});
    }
    result_.last_attempt = std::move(attempt);
    return resolve_fragments();
  }

  // ---- Fragments

  /// Forces of the pins that hold what has come off: no support, and no reaction.
  [[nodiscard]] double pin_force(const Attempt& attempt) const {
    return norm_of(pinned_.size(), [&](std::size_t dof) {
      return pinned_[dof] ? attempt.state.gradient[dof] - attempt.external_force[dof] : 0.0;
    });
  }

  void find_pieces() {
    const Assembler& assembler = active_->assembler;
    pieces_ = find_fragments(assembler.points(), assembler.model().bonds,
                             broken_bonds(assembler.model(), result_.state.history),
                             conditions_.prescribed(), result_.state.displacement);
    if (options_.fragments == FragmentRemedy::remove) remove_pieces();
  }

  /// Takes floating pieces out of the equations. One that a support still moves goes with it: only
  /// what is missing is pinned there.
  void remove_pieces() {
    const auto d = std::size_t(main_.assembler.points().dimension);
    const std::vector<char>& prescribed = conditions_.prescribed();
    std::vector<char> removed(std::size_t(pieces_.count) + 1, 1);
    removed[0] = 0;  // the pieces that are held
    for (std::size_t dof = 0; dof < prescribed.size(); ++dof) {
      if (prescribed[dof]) removed[std::size_t(pieces_.piece[dof / d])] = 0;
    }
    for (std::size_t dof = 0; dof < prescribed.size(); ++dof) {
      pieces_.pinned[dof] |= removed[std::size_t(pieces_.piece[dof / d])];
    }
  }

  /// Pins what has come free.
  bool resolve_fragments() {
    if (pieces_.pinned.empty() || pieces_.pinned == pinned_) return true;
    const std::string what = std::to_string(pieces_.count) + " floating pieces, " +
                             std::to_string(pieces_.loose.size()) + " loose points";
    const double load_factor = result_.state.load_factor;
    if (options_.fragments == FragmentRemedy::stop && pieces_.count > 0) {
      Attempt attempt = std::move(result_.last_attempt);
      attempt.outcome = Outcome::fragmented;
      return stop(std::move(attempt), 0.0, what);
    }
    const bool removes = options_.fragments == FragmentRemedy::remove;
    pinned_ = pieces_.pinned;
    tell(load_factor, 0.0, Outcome::converged, removes ? "remove fragments" : "hold fragments",
         relaxes_ ? relaxed_.value() : implicit_.value(), what);
    number_free_dofs();
    motion_ = {};
    return analyze();
  }

  /// Prepares the solver for other free degrees of freedom.
  bool analyze() {
    if (active_->solver.analyze(active_->tangent.pattern, *free_) == LinearOutcome::solved) {
      return true;
    }
    Attempt attempt = std::move(result_.last_attempt);
    attempt.outcome = Outcome::out_of_memory;
    return stop(std::move(attempt), 0.0, explanation(Outcome::out_of_memory));
  }

  void number_free_dofs() {
    std::vector<char> without_equation = conditions_.prescribed();
    for (std::size_t dof = 0; dof < pinned_.size(); ++dof) without_equation[dof] |= pinned_[dof];
    own_free_ = std::make_unique<FreeDofs>(without_equation, main_.assembler.points().dimension);
    free_ = own_free_.get();
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
  std::vector<char> pinned_;    // per degree of freedom
  const FreeDofs* free_;
  std::unique_ptr<FreeDofs> own_free_;  // once something is pinned
  Fragments pieces_;
  RelaxationMotion motion_;
  std::vector<double> force_;  // that does work, in the last accepted state
  Ledger ledger_;
  double released_energy_ = 0.0;  // by triangles and tetrahedra whose bonds were damaged
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
