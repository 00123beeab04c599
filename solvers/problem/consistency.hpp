#pragma once

#include <span>
#include <string>

#include "assembly/assembler.hpp"
#include "assembly/operators/tangent_operator.hpp"
#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Energies of a body since the start of its load path [J].
struct Ledger {
  double stored = 0.0, dissipated = 0.0;
  double drained = 0.0;         ///< taken out by relaxation
  double external_work = 0.0;   ///< of supports and loads over the accepted states, int P du
  double numerical_work = 0.0;  ///< what relaxation has spent beyond it
  double kinetic = 0.0;         ///< of a body in motion

  [[nodiscard]] double balance_error() const {
    return external_work + numerical_work - stored - dissipated - drained - kinetic;
  }
};

/// What a step found, before it is accepted.
struct FoundState {
  const Trial& trial;
  std::span<const double> external_force;
  double largest_residual = 0.0;  ///< that its driver accepts [N]; negative: it owes no equilibrium
  bool sums_all_work = false;     ///< its driver follows the work from iteration to iteration
  Ledger before, after;
};

/// Norm of the sum of the forces between points, which is zero where these act in pairs [N].
[[nodiscard]] double sum_of_internal_forces(const EquilibriumProblem& problem, const Trial& trial);

/// Looks for a balance that a found state breaks, after its damage has been committed. These checks
/// are cheap beside the step, and independent of the search that has found the state:
///
/// - in equilibrium: the residual, evaluated anew with the committed histories;
/// - no unbroken bond above what it bears: committing the state again would damage nothing;
/// - forces and moments of the interactions add up to zero, as far as the model owes it
///   (Model::balances). Round-off leaves about eps sum_b |f_b| <= eps sqrt(2 E tr K), by Cauchy and
///   Schwarz from E = sum_b f_b^2 / (2 k_b); a thousand times as much is a fault;
/// - the stored energy is not negative, where the model owes that, and dissipation never falls;
/// - no energy comes from nothing: where damage grew, or relaxation came to rest, what the body has
///   taken up is covered by work, up to a twentieth of what was turned over. That is what the
///   trapezoidal rule may err by where bonds break within a step; an implicit step that exceeds it
///   is too long for its work to be known. Elastic implicit steps owe nothing: their energy is a
///   function of the state. Nor do steps that still move: they hold energy of the steps before;
/// - products of forces and displacements do not underflow.
///
/// @param damaged the body whose bonds are damaged: not that of the equilibrium while an elastic
///        stand-in is in its place
/// @param tangent near the state: its diagonal sets the scale of round-off
/// @return a sentence for a person; empty if all is well
[[nodiscard]] std::string find_inconsistency(const EquilibriumProblem& problem, Assembler& damaged,
                                             const TangentOperator& tangent,
                                             const FoundState& found);

}  // namespace peristat
