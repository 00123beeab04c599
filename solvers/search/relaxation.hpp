#pragma once

#include <functional>
#include <vector>

#include "solvers/problem/equilibrium.hpp"
#include "solvers/problem/records.hpp"

namespace peristat {

/// How dynamic relaxation removes energy.
enum class Damping {
  /// c_n from the Rayleigh quotient of the present motion, as published, with the mass factor 1. It
  /// amplifies round-off, so that the bonds that break may depend on the number of threads.
  adaptive,
  /// No damping, but all motion stops whenever the kinetic energy has passed a peak. At the mass
  /// factor 1 the highest mode is at the limit of stability, and every second iteration looks like
  /// a peak; 2 avoids this.
  kinetic,
};

/// When bonds lose their integrity in relaxation.
enum class Breaking {
  at_equilibrium,  ///< histories follow accepted states only: overshoot breaks nothing
  transient,       ///< histories follow every iteration, as in [ADAPT]
};

/// Method by which a body finds its next equilibrium.
enum class RelaxationMethod {
  dynamic,  ///< artificial dynamics with damping: see relax
  flow,     ///< no inertia: see flow
};

struct RelaxationOptions {
  RelaxationMethod method = RelaxationMethod::dynamic;
  double relative_tolerance = 1e-10;  ///< of the residual
  /// ||du|| / ||u|| of an iteration below which relaxation ends too ([ADAPT] eq. 16); 0: never.
  /// Such a state need not be in equilibrium.
  double displacement_tolerance = 0.0;
  int ramp = 100;     ///< iterations over which supports and loads move to their new values
  bool holds = true;  ///< relaxes at the fixed load after the ramp; otherwise ends with it
  int max_iterations = 50'000;
  int quiet_iterations = 50;  ///< without a further broken bond before acceptance
  double scale = 0.0;         ///< that the residual is measured against [N]; 0: that of this step
  double mass_factor = 2.0;   ///< of the stable limit of the pseudo density; see Damping
  Damping damping = Damping::kinetic;
  Breaking breaking = Breaking::at_equilibrium;
  /// Flow: fraction of a step's length by which the step may leave the flow's path.
  double flow_tolerance = 0.1;
};

struct RelaxationResult {
  Outcome outcome = Outcome::converged;
  int iterations = 0;
  Trial state;  ///< last state, with its broken bonds; equilibrium only if converged and held
  std::vector<double> external_force;
  double scale = 0.0;  ///< norm that the residual was measured against [N]
  /// Residual that counted as equilibrium [N]; negative: equilibrium was not required, the state
  /// has merely settled, or still moves.
  double largest_residual = 0.0;
  double external_work = 0.0;    ///< of supports and loads [J]
  double drained_energy = 0.0;   ///< external work minus what the bonds have taken up [J]
  double damped_energy = 0.0;    ///< by damping, and by stopping motion: see relax [J]
  DamageGrowth growth;           ///< of transient breaking
  double released_energy = 0.0;  ///< of transient breaking, see Evaluation::released [J]
};

/// Called for every hundredth iteration of dynamic relaxation and for the last, and for every step
/// of a flow; returns true to interrupt.
using RelaxationObserver = std::function<bool(const IterationRecord&)>;

/// Norm that the residual of a relaxation is measured against [N]: residual_scale after the jump of
/// supports and loads to a load point, or the forces of its environment if they are larger.
/// @param start evaluated state in which the relaxation begins
/// @param jumps false: residual_scale of the start under the loads of that point
[[nodiscard]] double relaxation_scale(const EquilibriumProblem& problem, const Trial& start,
                                      const LoadPoint& to, bool jumps);

/// Energy that the bonds have taken up, stored or dissipated, since the history that they began
/// with [J].
[[nodiscard]] double taken_up(const EquilibriumProblem& problem, Breaking breaking,
                              const Trial& at);

}  // namespace peristat
