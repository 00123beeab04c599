#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solvers/dynamic_relaxation.hpp"
#include "solvers/fragment_pins.hpp"
#include "solvers/newton.hpp"
#include "src/input_error.hpp"

namespace peristat {

/// How the equilibria of a load path are found.
enum class Mode {
  newton,      ///< implicitly throughout
  relaxation,  ///< by dynamic relaxation throughout
  adaptive,    ///< implicitly while no damage grows, by relaxation while it does
};

struct LoadSteppingOptions {
  Mode mode = Mode::newton;
  int steps = 1;         ///< equal steps of the load factor from 0 to 1
  bool adaptive = true;  ///< cut after a failure and grow again; otherwise a failure ends the run
  double smallest_step = 1e-6;  ///< of the load factor; a cut below it ends the run
  double largest_step = 0.0;    ///< of the load factor; 0 means 1 / steps
  double cut = 0.5;             ///< factor of the step after a failure
  double growth = 2.0;          ///< factor of the step after an easy success, up to largest_step
  int easy_iterations = 5;      ///< a step with no more iterations than this was easy
  /// Bonds that may break in one implicit step; a step with more is cut. 0: no limit.
  int max_broken_bonds = 0;
  int relaxation_steps = 1;  ///< equal steps of the load factor in relaxation
  RelaxationOptions relaxation;
  /// Relative residual of a relaxed step at which Newton's method takes its last iterations over,
  /// in adaptive mode.
  double newton_takes_over_at = 1e-5;
  FragmentRemedy fragments = FragmentRemedy::hold;
};

/// What an accepted state is made of besides its record.
struct AcceptedState {
  const Trial& trial;  ///< with its damage committed
  const std::vector<double>& external_force;
  std::span<const std::int32_t> piece;  ///< per point, see Fragments; empty: none
};

/// Receives what happens; all members may be empty.
struct LoadSteppingObserver {
  std::function<void(const IterationRecord&)> iteration;
  std::function<void(const DecisionRecord&)> decision;
  /// An accepted state. The record's energies, damage and reactions are set.
  std::function<void(const StepRecord&, const AcceptedState&)> accepted;
  std::function<bool()> interrupted;
  /// A sentence about an error of supports or loads that shows only at some load factor.
  std::function<std::string(const InputError&)> describe;
};

/// The last search for equilibrium, for what is told when it failed.
struct Attempt {
  Outcome outcome = Outcome::converged;
  int iterations = 0;
  double load_factor = 0.0;
  double scale = 0.0;  ///< norm that the residual was measured against [N]
  std::optional<Inertia> inertia;
  bool has_negative_pivots = false;
  bool unstable_start = false;
  double largest_residual = 0.0;  ///< that counts as equilibrium [N]; negative: none was asked for
  std::string note;               ///< what else is to be told if it is accepted
  Trial state;
  std::vector<double> external_force;
};

struct LoadSteppingResult {
  Outcome outcome = Outcome::converged;
  int steps = 0;                    ///< accepted
  State state;                      ///< last accepted
  double relaxation_seconds = 0.0;  ///< wall time in relaxation
  Attempt last_attempt;
};

/// A body, and what searches its equilibria.
struct SolvedBody {
  Assembler& assembler;
  LinearSolver& solver;  ///< analyzed for the body's pattern and `free`
  TangentOperator& tangent;
  const FreeDofs& free;  ///< what the supports leave free
};

/// Follows the equilibrium from load factor 0 to 1 in steps; every decision is told.
///
/// Mode `adaptive`: implicit steps go on until one would damage a bond (further). It is cut to the
/// load at which damage begins, interpolated in the utilisation of the bonds; what is left is taken
/// over by relaxation, from the last accepted state. Relaxation goes on in steps of its own while
/// damage grows. In each of them Newton's method does the last iterations as soon as no further
/// bond breaks and the residual is small. A relaxed step in which nothing was damaged hands back.
///
/// External work is summed with the trapezoidal rule over each step, of the loads on the free and
/// of the reactions on the prescribed degrees of freedom. Relaxation sums the work over each of its
/// iterations, too: what that is more is the numerical work. The balance error is that rule's in
/// implicit steps, and what unstable ones release.
///
/// Before a step is accepted it is checked against what it owes (find_inconsistency); a step that
/// fails is cut like one that does not converge.
///
/// @param stand_in a body with the same points that is elastic and has another horizon: it takes
///        the place of the body until damage begins. The body's ledger then begins with what it
///        stores in equilibrium at that load: the work that elastic steps to there would have done
[[nodiscard]] LoadSteppingResult follow_loading(const SolvedBody& body,
                                                const Conditions& conditions,
                                                const LoadSteppingOptions& options,
                                                const NewtonOptions& newton_options,
                                                const LoadSteppingObserver& observer,
                                                const SolvedBody* stand_in = nullptr);

}  // namespace peristat
