#pragma once

#include "solvers/linear/linear_solver.hpp"
#include "solvers/search/relaxation.hpp"

namespace peristat {

/// Moves supports and loads from their values in a state to a load point and relaxes without
/// inertia:
///
///   du/dt = d(u),   K0 d = F(u) = f_ext - dE/dx     on the free degrees of freedom,
///
/// the limit of slow motion with damping and no mass. K0 is the tangent of the start with the
/// damage held and every interaction projected to its positive semidefinite part. No softening
/// makes the body stiffer than that, so that along u + theta d, 0 <= theta <= 1, the energy falls
/// throughout and there is no energy barrier. It is factorised once; each step costs a solve.
///
/// In the metric of K0 all motions of the elastic body decay with the rate 1. A step of the
/// exponential Euler rule, theta = 1 - exp(-h), is exact for it: theta = 1, Newton's method with a
/// fixed tangent, reaches equilibrium at once. With the direction d1 at its end, the step neglects
///
///   e = c [d1 - (1 - theta) d],   c = (h - 1 + exp(-h)) / h.
///
/// Along d this is only an error in time, which is irrelevant; across d the step leaves the flow's
/// path. That part, |e across| / |theta d| in the norm of K0 (d.K0 d = d.F needs no product), is
/// held below `flow_tolerance`. A motion that has lost most of its stiffness decays slowly: theta
/// then grows beyond 1, as long as the force along d does not change its sign, up to half of what
/// the rate of that motion allows.
///
/// Supports and loads move to their new values in one predictor K0 du_f = F - K0_fp du_p, or in
/// shorter ones if the direction after it is not small compared with it.
///
/// The energy of the accepted steps falls once the loads are constant; the lost energy is drained.
/// @param solver analysed for the tangent's pattern and the free degrees of freedom
/// @param tangent workspace for K0
[[nodiscard]] RelaxationResult flow(const EquilibriumProblem& problem, LinearSolver& solver,
                                    TangentOperator& tangent, const State& from,
                                    const LoadPoint& to, const RelaxationOptions& options,
                                    const RelaxationObserver& observer);

}  // namespace peristat
