#pragma once

#include <vector>

#include "assembly/operators/tangent.hpp"
#include "solvers/problem/equilibrium.hpp"
#include "solvers/search/relaxation.hpp"

namespace peristat {

/// Velocity of the pseudo-dynamics, carried over to the next step if a step does not hold its load.
struct RelaxationMotion {
  std::vector<double> velocity;  ///< V^(n+1/2) per equation; empty: at rest
};

/// Moves supports and loads from their values in a state to a load point and relaxes, by explicit
/// adaptive dynamic relaxation (Kilic and Madenci 2010, as [ADAPT] uses it) with the pseudo time
/// step 1:
///
///   lambda_i >= 1/4 sum_j |K_ij|                            (Gershgorin, current tangent)
///   V^(1/2) = F^0 / (2 lambda)
///   V^(n+1/2) = [(2 - c_n) V^(n-1/2) + 2 F^n / lambda] / (2 + c_n),   U^(n+1) = U^n + V^(n+1/2)
///   c_n = 2 sqrt(U.K1 U / U.U),  K1_i = -(F_i^n - F_i^(n-1)) / (lambda_i V_i^(n-1/2))
///
/// F is the residual f_ext - dE/dx on the free degrees of freedom, over which the sums of c_n run.
/// They are global, so that the result depends on the number of threads by round-off alone (which
/// c_n amplifies: the bonds that break in a burst may differ). Terms with V_i = 0 are left out; a
/// negative quotient gives c_n = 0, and c_n > 2 gives 1.9, as is customary.
///
/// The work of supports and loads is summed over the iterations with the trapezoidal rule. The part
/// of it that the bonds have not taken up is drained: a relaxation that holds begins and ends at
/// rest. The energy that leaves is also summed by itself. With the mean velocity Vm of two half
/// steps damping takes c_n lambda Vm^2. By the leap-frog rule the sum of that and of the energy of
/// stopped motion equals the trapezoidal work of F along the path. Both sums agree up to the error
/// of that rule, which falls with the square of the ramp (1e-6 of the work for 100 iterations in
/// 2D) and is some per cent where bonds break within an iteration.
/// @param tangent workspace for the tangent that gives the density
/// @param motion at the start, and at the end if the relaxation does not hold
[[nodiscard]] RelaxationResult relax(const EquilibriumProblem& problem, TangentOperator& tangent,
                                     const State& from, const LoadPoint& to,
                                     const RelaxationOptions& options, RelaxationMotion& motion,
                                     const RelaxationObserver& observer);

}  // namespace peristat
