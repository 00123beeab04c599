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
  double numerical_work = 0.0;  ///< spent by relaxation beyond external_work
  double kinetic = 0.0;         ///< of a body in motion

  [[nodiscard]] double balance_error() const {
    return external_work + numerical_work - stored - dissipated - drained - kinetic;
  }
};

/// State that a step has found, before it is accepted.
struct FoundState {
  const Trial& trial;
  std::span<const double> external_force;
  double largest_residual = 0.0;  ///< that its driver accepts [N]; negative: none is required
  bool sums_all_work = false;     ///< its driver sums the work over iterations
  Ledger before, after;
};

/// Norm of the sum of the forces between points, which is zero where these act in pairs [N].
[[nodiscard]] double sum_of_internal_forces(const EquilibriumProblem& problem, const Trial& trial);

/// Checks the balances of a found state after its damage has been committed. The checks are cheap
/// beside the step, and independent of the search that has found the state:
///
/// - equilibrium: the residual, evaluated anew with the committed histories;
/// - strength: no unbroken bond is stretched beyond what it bears, so that committing the state
///   again would damage nothing;
/// - forces and moments of the interactions add up to zero, as far as the model requires it
///   (Model::balances). Round-off leaves about eps sum_b |f_b| <= eps sqrt(2 E tr K), by Cauchy and
///   Schwarz from E = sum_b f_b^2 / (2 k_b); a thousand times as much is a fault;
/// - the stored energy is not negative, where the model requires that, and dissipation never falls;
/// - no energy comes from nothing: where damage grew, or relaxation came to rest, work covers what
///   the body has stored and dissipated, up to a twentieth of what was turned over. That is the
///   possible error of the trapezoidal rule where bonds break within a step; an implicit step that
///   exceeds it is too long for its work to be known. Elastic implicit steps are exempt, as their
///   energy is a function of the state, and so are steps that still move, as they hold energy of
///   earlier steps;
/// - products of forces and displacements do not underflow.
///
/// @param damaged the body whose bonds are damaged; it is not that of the equilibrium while an
///        elastic stand-in replaces it
/// @param tangent near the state: its diagonal sets the scale of round-off
/// @return a message for the user; empty if no check fails
[[nodiscard]] std::string find_inconsistency(const EquilibriumProblem& problem, Assembler& damaged,
                                             const TangentOperator& tangent,
                                             const FoundState& found);

}  // namespace peristat
