#pragma once

#include "solvers/linear/linear_solver.hpp"
#include "solvers/search/relaxation.hpp"

namespace peristat {

/// Moves supports and loads from where a state has them to a load point and relaxes without
/// inertia:
///
///   du/dt = d(u),   K0 d = F(u) = f_ext - dE/dx     on the free degrees of freedom,
///
/// what slow motion with damping and no mass tends to. K0 is the tangent of the start with the
/// damage held and every interaction projected to its positive semidefinite part: no softening
/// makes the body stiffer than that, so that along u + theta d, 0 <= theta <= 1, the energy falls
/// throughout and no barrier lies on the way. It is factorised once; each step costs a solve.
///
/// In the metric of K0 the elastic body decays with the rate 1 in all its motions. A step of the
/// exponential Euler rule, theta = 1 - exp(-h), is exact for it: theta = 1, Newton's method with a
/// fixed tangent, ends it at once. What it neglects is, with the direction d1 at its end,
///
///   e = c [d1 - (1 - theta) d],   c = (h - 1 + exp(-h)) / h.
///
/// Along d this is a matter of time, which nobody asks for; across it the step leaves the flow's
/// path. Its share |e across| / |theta d|, in the norm of K0 (d.K0 d = d.F needs no product), is
/// held below `flow_tolerance`. A motion that has lost most of its stiffness turns slowly: there
/// theta grows beyond 1, as long as the force along d does not change its sign, up to half of what
/// the rate of that motion asks for.
///
/// Supports and loads go their way in one predictor K0 du_f = F - K0_fp du_p, or in shorter ones
/// where the direction after it is not small beside it.
///
/// The energy of the accepted steps falls once the loads stand still; what is lost is drained.
/// @param solver analyzed for the tangent's pattern and the free degrees of freedom
/// @param tangent room for K0
[[nodiscard]] RelaxationResult flow(const EquilibriumProblem& problem, LinearSolver& solver,
                                    TangentOperator& tangent, const State& from,
                                    const LoadPoint& to, const RelaxationOptions& options,
                                    const RelaxationObserver& observer);

}  // namespace peristat
