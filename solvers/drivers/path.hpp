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

/// A body with the solver, tangent and equations that its equilibria are searched with.
struct SolvedBody {
  Assembler& assembler;
  LinearSolver& solver;  ///< analyzed for the body's pattern and `free`
  TangentOperator& tangent;
  const FreeDofs& free;  ///< degrees of freedom that the supports leave free
};

/// Setting of a path; everything that it refers to outlives the path.
struct PathSetting {
  SolvedBody body;
  const Conditions& conditions;
  const LoadSteppingOptions& options;
  const NewtonOptions& newton_options;
  const LoadSteppingObserver& observer;
  const SolvedBody* stand_in = nullptr;   ///< see follow_loading
  const MotionSetting* motion = nullptr;  ///< of mode dynamics
  InitialCuts cuts{};                     ///< of mode fatigue
};

/// Does a driver go on?
enum class Advance { goes_on, ended };

/// A path and its state, with what all drivers share: searches and reports.
class Path {
 public:
  /// Begins at rest, before the preload.
  explicit Path(const PathSetting& setting);

  /// Begins at a state that a path with the same setting has reached. Its solvers must be prepared
  /// before a driver goes on.
  /// @throws std::logic_error if its stand-in is in use and there is none
  Path(const PathSetting& setting, PathState from);

  /// Prepares the solvers for the equations of the state, on its rungs of their ladders.
  [[nodiscard]] LinearOutcome prepare_solvers();

  [[nodiscard]] const PathSetting& setting() const { return setting_; }
  [[nodiscard]] const LoadSteppingOptions& options() const { return setting_.options; }
  [[nodiscard]] PathState& state() { return state_; }
  [[nodiscard]] const PathState& state() const { return state_; }
  [[nodiscard]] Outcome outcome() const { return outcome_; }
  [[nodiscard]] Attempt& last_attempt() { return last_attempt_; }

  /// True if there is load left, and the force has not fallen to where the path ends.
  [[nodiscard]] bool goes_on() const;
  /// True if the supports' force has fallen below the fraction of its peak that ends the path, at a
  /// load that the body has not carried before: a fall by a planned unloading is no failure.
  [[nodiscard]] bool has_fallen() const;
  /// True if step 0, the state at load 0, is still to be found.
  [[nodiscard]] bool is_preloading() const { return state_.accepted.preload < 1.0; }
  [[nodiscard]] int next_step() const { return is_preloading() ? 0 : state_.steps + 1; }

  /// The body in use: its stand-in (surrogate model) until damage begins.
  [[nodiscard]] const SolvedBody& body() const;
  /// The body whose bonds are damaged, even if a stand-in is in use.
  [[nodiscard]] Assembler& damaged() const { return setting_.body.assembler; }
  /// The equations, without pinned degrees of freedom.
  [[nodiscard]] const FreeDofs& free() const;
  [[nodiscard]] EquilibriumProblem problem() const;
  [[nodiscard]] std::vector<double> working_force(const Trial& state,
                                                  std::span<const double> external_force) const;

  /// Returns why supports and loads have no value at a load point; nothing if they have.
  [[nodiscard]] std::optional<std::string> refusal_of_conditions(const LoadPoint& at) const;

  /// Searches by Newton's method, under the conditions' control if they have one. The preload is
  /// applied before the control begins.
  [[nodiscard]] Attempt search(const State& from, const LoadPoint& target,
                               const NewtonOptions& options);
  /// Searches by Newton's method with the load as an unknown.
  [[nodiscard]] Attempt search(const State& from, const BorderedStep& step,
                               const NewtonOptions& options);

  /// Prepares the solver of the body in use for the present equations.
  [[nodiscard]] Advance analyze();
  /// Pins the fragments that were found last, which changes the equations.
  [[nodiscard]] Advance pin();
  /// Returns to the equations of earlier pins.
  [[nodiscard]] Advance pin_as_before(FragmentPins pins);

  /// Reports an iteration of the next step; returns true to interrupt.
  [[nodiscard]] bool iterated(IterationRecord row) const;
  /// Reports a decision about the next step.
  /// @param at load point that was attempted
  void tell(const LoadPoint& at, DecisionRecord decision) const;
  /// Reports an equilibrium that is about to be committed.
  void tell_commit(const Attempt& attempt) const;
  /// Ends the path with an attempt that failed.
  [[nodiscard]] Advance stop(Attempt attempt, double attempted, const std::string& reason);

  void forget_last_attempt() { last_attempt_ = {}; }  // frees the vectors of a large body
  void note_rungs();

 private:
  void number_equations();
  [[nodiscard]] Attempt search_by_control(const State& from, double target,
                                          const NewtonOptions& options);
  /// Refuses a state that the body would leave although its control is fixed. A state may have one
  /// negative pivot only if the load has turned since rest (the determinant of the tangent changes
  /// its sign with the rate of the control). Otherwise a bifurcation has been passed.
  void judge_stability_under_control(Attempt& found, const LoadPath& loads);
  void find_control_sign();
  [[nodiscard]] std::string description(const InputError& error) const;
  /// Counts the pivots in the state in which a search has ended, for the report.
  void count_pivots(Attempt& attempt) const;

  PathSetting setting_;
  PathState state_;
  std::unique_ptr<FreeDofs> own_free_;  // once something is pinned
  Outcome outcome_ = Outcome::converged;
  Attempt last_attempt_;
};

}  // namespace peristat
