#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "assembly/operators/tangent.hpp"
#include "solvers/linear/linear_solver.hpp"
#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Linear systems of Newton's iterations. In a large body the memory of vectors counts: none that
/// is not needed exists during a solve.
class Linearisation {
 public:
  /// The arguments outlive it.
  Linearisation(const EquilibriumProblem& problem, LinearSolver& solver, TangentOperator& tangent,
                std::span<const double> external_force)
      : problem_(problem), solver_(solver), tangent_(tangent), external_force_(external_force) {}

  /// Finds the direction du with K_ff du_f = f_ext - dE/dx_f - K_fp jump_p at a state.
  /// @param projection share of the projection of interactions; after the exact tangent (0) of a
  ///        state any other share may follow at the same state
  /// @param after_jump displacement with the new values of the prescribed degrees of freedom, whose
  ///        difference from the state's is the jump; empty for none
  /// @param tolerance of the linear system's relative residual
  [[nodiscard]] LinearOutcome solve(const StateView& at, std::span<const double> gradient,
                                    double projection, FactorUse use,
                                    std::span<const double> after_jump, double tolerance,
                                    std::vector<double>& direction);

  /// Finds the direction for another force by the tangent of the last solve: K_ff du_f = force_f -
  /// K_fp jump_p.
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
  /// Projected minus exact blocks of the present state, diagonal and off-diagonal.
  std::optional<std::pair<std::vector<double>, std::vector<double>>> to_projected_;
  double projection_ = 0.0;
  bool exact_is_known_ = false;
  std::span<const double> external_force_;
};

/// Outcome of a search whose linear system ended like this.
[[nodiscard]] Outcome outcome_of(LinearOutcome linear);

/// Relative residual to which a linear system is solved (choice 2 of Eisenstat and Walker, SIAM J.
/// Sci. Comput. 17, 1996, with exponent 2, for which Newton stays quadratic): the square of the
/// last iteration's gain, but no more digits than the target needs.
/// @param last residual of the previous iteration, 0 in the first one
[[nodiscard]] double forcing_term(double residual, double last, double target);

}  // namespace peristat
