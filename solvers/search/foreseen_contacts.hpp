#pragma once

#include <functional>
#include <vector>

#include "solvers/linear/linear_solver.hpp"
#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Solves the linear problem of a predictor. Contacts have no stiffness before they press: those
/// that the predictor foresees as closed count as springs (StateView::foreseen), in rounds until
/// they are those that it closes.
/// @param foreseen displacement that the predictor is expected to lead to; afterwards that of the
///        last linear problem
/// @param start the state about which the predictor linearises, with `foreseen`
/// @param solve the linear problem there; stores the displacement that it leads to
/// @return the outcome of the last linear problem
[[nodiscard]] LinearOutcome predict_with_contacts(
    const EquilibriumProblem& problem, std::vector<double>& foreseen,
    const std::function<StateView()>& start,
    const std::function<LinearOutcome(std::vector<double>& next)>& solve);

}  // namespace peristat
