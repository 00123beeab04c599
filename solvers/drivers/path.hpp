#pragma once

#include <memory>
#include <optional>
#include <string>

#include "solvers/drivers/attempt.hpp"
#include "solvers/drivers/load_stepping_options.hpp"
#include "solvers/drivers/observer.hpp"
#include "solvers/drivers/path_state.hpp"
#include "solvers/motion/motion_setting.hpp"
#include "solvers/search/bordered_newton.hpp"

namespace peristat {

/// A body, and what searches its equilibria.
struct SolvedBody {
  Assembler& assembler;
  LinearSolver& solver;  ///< analyzed for the body's pattern and `free`
  TangentOperator& tangent;
  const FreeDofs& free;  ///< what the supports leave free
};

/// What a path is followed with; all that it refers to outlives the path.
struct PathSetting {
  SolvedBody body;
  const Conditions& conditions;
  const LoadSteppingOptions& options;
  const NewtonOptions& newton_options;
  const LoadSteppingObserver& observer;
  const SolvedBody* stand_in = nullptr;   ///< see follow_loading
  const MotionSetting* motion = nullptr;  ///< of mode dynamics
};

/// Whether a driver goes on.
enum class Advance { goes_on, ended };

/// A path and its state, with what all drivers share: searches, and telling what happens.
class Path {
 public:
  /// From rest, before what acts at load 0 is put on.
  explicit Path(const PathSetting& setting);

  /// From a state that a path with the same setting has reached. Its solvers have to be prepared
  /// before a driver goes on.
  /// @throws std::logic_error if its stand-in is in force and there is none
  Path(const PathSetting& setting, PathState from);

  /// Puts the solvers on the rungs, and before the equations, of the state.
  [[nodiscard]] LinearOutcome prepare_solvers();

  [[nodiscard]] const PathSetting& setting() const { return setting_; }
  [[nodiscard]] const LoadSteppingOptions& options() const { return setting_.options; }
  [[nodiscard]] PathState& state() { return state_; }
  [[nodiscard]] const PathState& state() const { return state_; }
  [[nodiscard]] Outcome outcome() const { return outcome_; }
  [[nodiscard]] Attempt& last_attempt() { return last_attempt_; }

  /// Whether it goes on: there is load left, and the force has not fallen to where it is to end.
  [[nodiscard]] bool goes_on() const;
  /// Whether the supports' force has fallen below the share of its peak that ends the path, at a
  /// load that the body has not borne before: what falls with a planned unloading has not failed.
  [[nodiscard]] bool has_fallen() const;
  /// Whether step 0, the state at load 0, is still to be found.
  [[nodiscard]] bool is_preloading() const { return state_.accepted.preload < 1.0; }
  [[nodiscard]] int next_step() const { return is_preloading() ? 0 : state_.steps + 1; }

  /// The body in force: the stand-in until damage begins.
  [[nodiscard]] const SolvedBody& body() const;
  /// The body whose bonds are damaged, whatever stands in for it.
  [[nodiscard]] Assembler& damaged() const { return setting_.body.assembler; }
  /// The equations, without what is pinned.
  [[nodiscard]] const FreeDofs& free() const;
  [[nodiscard]] EquilibriumProblem problem() const;
  [[nodiscard]] std::vector<double> working_force(const Trial& state,
                                                  std::span<const double> external_force) const;

  /// Why supports and loads have no value at a stage, if that is so.
  [[nodiscard]] std::optional<std::string> refusal_of_conditions(const LoadPoint& at) const;

  /// By Newton's method, under the conditions' control if they have one. What acts at load 0 is put
  /// on before the control begins.
  [[nodiscard]] Attempt search(const State& from, const LoadPoint& target,
                               const NewtonOptions& options);
  /// By Newton's method with a load that is found, too.
  [[nodiscard]] Attempt search(const State& from, const BorderedStep& step,
                               const NewtonOptions& options);

  /// Prepares the solver of the body in force for the equations.
  [[nodiscard]] Advance analyze();
  /// Pins what was found last: there are other equations.
  [[nodiscard]] Advance pin();
  /// Goes back to the equations of earlier pins.
  [[nodiscard]] Advance pin_as_before(FragmentPins pins);

  /// Told of every iteration of the next step; returns true to interrupt.
  [[nodiscard]] bool iterated(IterationRecord row) const;
  /// Tells a decision about the next step.
  /// @param at that was attempted
  void tell(const LoadPoint& at, DecisionRecord decision) const;
  /// Ends the path with an attempt that failed.
  [[nodiscard]] Advance stop(Attempt attempt, double attempted, const std::string& reason);

  void forget_last_attempt() { last_attempt_ = {}; }  // the vectors of a large body count
  void note_rungs();

 private:
  void number_equations();
  [[nodiscard]] Attempt search_by_control(const State& from, double target,
                                          const NewtonOptions& options);
  /// Refuses a state that a body would leave although its control stands still: it may have one
  /// negative pivot, and that only if the load turned since rest (the determinant of the tangent
  /// changes its sign with the control's answer). Otherwise a bifurcation has been passed.
  void judge_stability_under_control(Attempt& found, const LoadPath& loads);
  void find_control_sign();
  [[nodiscard]] std::string description(const InputError& error) const;
  /// Of the state that a search has ended in, for what is told of it.
  void count_pivots(Attempt& attempt) const;

  PathSetting setting_;
  PathState state_;
  std::unique_ptr<FreeDofs> own_free_;  // once something is pinned
  Outcome outcome_ = Outcome::converged;
  Attempt last_attempt_;
};

}  // namespace peristat
