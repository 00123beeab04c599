#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "assembly/operators/tangent.hpp"
#include "solvers/linear/linear_solver.hpp"
#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Linear systems of Newton's iterations. Of a large body the vectors count: none lives while a
/// system is solved that isn't needed then.
class Linearisation {
 public:
  /// All outlive it.
  Linearisation(const EquilibriumProblem& problem, LinearSolver& solver, TangentOperator& tangent,
                std::span<const double> external_force)
      : problem_(problem), solver_(solver), tangent_(tangent), external_force_(external_force) {}

  /// Finds the direction du with K_ff du_f = f_ext - dE/dx_f - K_fp jump_p at a state.
  /// @param projection of the interactions; after the exact tangent (0) of a state any other share
  ///        may follow at the same state
  /// @param after_jump displacement whose difference from the state's is the jump of the prescribed
  ///        ones; empty for none
  /// @param tolerance of the linear system's relative residual
  [[nodiscard]] LinearOutcome solve(const StateView& at, std::span<const double> gradient,
                                    double projection, FactorUse use,
                                    std::span<const double> after_jump, double tolerance,
                                    std::vector<double>& direction);

  /// Finds the direction of another force by the tangent that was solved with last: K_ff du_f =
  /// force_f - K_fp jump_p.
  /// @param jump of the prescribed displacements, zero elsewhere; empty for none
  [[nodiscard]] LinearOutcome solve_again(std::span<const double> force,
                                          std::span<const double> jump, double tolerance,
                                          std::vector<double>& direction);

 private:
  void assemble(const StateView& at, double projection);
  /// right_hand_side -= K_fp jump_p
  void take_off_support_force(std::span<const double> jump,
                              std::span<double> right_hand_side) const;
  [[nodiscard]] LinearOutcome solve_for(std::span<const double> right_hand_side, double tolerance,
                                        std::vector<double>& direction);

  const EquilibriumProblem& problem_;
  LinearSolver& solver_;
  TangentOperator& tangent_;
  /// Projected minus exact blocks of the present state, on the diagonal and beside it.
  std::optional<std::pair<std::vector<double>, std::vector<double>>> to_projected_;
  double projection_ = 0.0;
  bool exact_is_known_ = false;
  std::span<const double> external_force_;
};

/// What a linear system's end means for the search that it is of.
[[nodiscard]] Outcome outcome_of(LinearOutcome linear);

/// Relative residual to which a linear system is solved (choice 2 of Eisenstat and Walker, SIAM J.
/// Sci. Comput. 17, 1996, with exponent 2, for which Newton stays quadratic): the square of the
/// last iteration's gain, but no more digits than the target needs.
/// @param last that of the iteration before, 0 in the first one
[[nodiscard]] double forcing_term(double residual, double last, double target);

}  // namespace peristat
