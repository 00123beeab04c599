#pragma once

#include <functional>
#include <vector>

#include "assembly/operators/tangent.hpp"
#include "solvers/problem/equilibrium.hpp"
#include "solvers/problem/records.hpp"

namespace peristat {

/// How dynamic relaxation takes energy out.
enum class Damping {
  /// c_n from the Rayleigh quotient of the present motion, as published, with the mass factor 1. It
  /// amplifies round-off, so that which bonds break may hang on the number of threads.
  adaptive,
  /// None, but all motion stops whenever the kinetic energy has passed a peak. At the mass factor 1
  /// the highest mode sits at the limit of stability, and every second iteration looks like a peak;
  /// 2 keeps clear of it.
  kinetic,
};

/// When bonds lose their integrity in relaxation.
enum class Breaking {
  at_equilibrium,  ///< histories follow accepted states only: overshoot breaks nothing
  transient,       ///< histories follow every iteration, as in [ADAPT]
};

struct RelaxationOptions {
  double relative_tolerance = 1e-10;  ///< of the residual
  /// ||du|| / ||u|| of an iteration below which relaxation ends too ([ADAPT] eq. 16); 0: never.
  /// Such a state need not be in equilibrium.
  double displacement_tolerance = 0.0;
  int ramp = 100;     ///< iterations over which supports and loads move to their new values
  bool holds = true;  ///< relaxes at the fixed load after the ramp; otherwise ends with it
  int max_iterations = 50'000;
  int quiet_iterations = 50;  ///< without a further broken bond before a state may be accepted
  double scale = 0.0;         ///< that the residual is measured against [N]; 0: that of this step
  double mass_factor = 2.0;   ///< of the stable limit of the pseudo density; see Damping
  Damping damping = Damping::kinetic;
  Breaking breaking = Breaking::at_equilibrium;
};

struct RelaxationResult {
  Outcome outcome = Outcome::converged;
  int iterations = 0;
  Trial state;  ///< last state, with what it has broken; equilibrium only if converged and held
  std::vector<double> external_force;
  double scale = 0.0;  ///< norm that the residual was measured against [N]
  /// Residual that counted as equilibrium [N]; negative: none was asked for, the state has merely
  /// settled, or still moves.
  double largest_residual = 0.0;
  double external_work = 0.0;    ///< of supports and loads [J]
  double drained_energy = 0.0;   ///< external work minus what the bonds have taken up [J]
  double damped_energy = 0.0;    ///< by damping, and by stopping motion: see relax [J]
  DamageGrowth growth;           ///< of transient breaking
  double released_energy = 0.0;  ///< of transient breaking, see Evaluation::released [J]
};

/// Motion of the pseudo dynamics that lasts from one step to the next where a step does not hold.
struct RelaxationMotion {
  std::vector<double> velocity;  ///< V^(n+1/2) per equation; empty: at rest
};

/// Told of every hundredth iteration and of the last; returns true to interrupt.
using RelaxationObserver = std::function<bool(const IterationRecord&)>;

/// Moves supports and loads from a state's stage to the given one and relaxes, by explicit
/// adaptive dynamic relaxation (Kilic and Madenci 2010, as [ADAPT] uses it) with the
/// pseudo time step 1:
///
///   lambda_i >= 1/4 sum_j |K_ij|                            (Gershgorin, current tangent)
///   V^(1/2) = F^0 / (2 lambda)
///   V^(n+1/2) = [(2 - c_n) V^(n-1/2) + 2 F^n / lambda] / (2 + c_n),   U^(n+1) = U^n + V^(n+1/2)
///   c_n = 2 sqrt(U.K1 U / U.U),  K1_i = -(F_i^n - F_i^(n-1)) / (lambda_i V_i^(n-1/2))
///
/// F is the residual f_ext - dE/dx on the free degrees of freedom, over which the sums of c_n go;
/// they are global, so that the result depends on the number of threads by round-off alone (which
/// c_n amplifies: what breaks in a burst may differ). Where V_i = 0 the
/// term is left out; a negative quotient gives c_n = 0, and c_n > 2 gives 1.9, as is customary.
///
/// The work of supports and loads is summed over the iterations with the trapezoidal rule. What the
/// bonds have not taken up of it is drained: a relaxation that holds begins and ends at rest. The
/// energy that leaves is also summed by itself: with the mean velocity Vm of two half steps damping
/// takes c_n lambda Vm^2, and the leap-frog rule makes the sum of that and of the motion that is
/// stopped equal to the trapezoidal work of F along the path. Both agree up to that rule's error,
/// which falls with the square of the ramp (1e-6 of the work for 100 iterations in 2D) and is some
/// per cent where bonds break within an iteration.
/// @param tangent room for the tangent that the density is made from
/// @param motion at the start, and at the end if the relaxation does not hold
[[nodiscard]] RelaxationResult relax(const EquilibriumProblem& problem, TangentOperator& tangent,
                                     const State& from, double stage,
                                     const RelaxationOptions& options, RelaxationMotion& motion,
                                     const RelaxationObserver& observer);

}  // namespace peristat
