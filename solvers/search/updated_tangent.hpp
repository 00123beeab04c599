#pragma once

#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "assembly/borne_stretches.hpp"
#include "solvers/linear/linear_solver.hpp"
#include "solvers/problem/equilibrium.hpp"
#include "solvers/search/known_corrections.hpp"

namespace peristat {

/// Value from which an UpdatedTangent can be restored.
struct TangentReference {
  State at;                           ///< state of linearisation; without displacements: none yet
  std::vector<LostStiffness> lost{};  ///< lost since
  KnownCorrections known{};           ///< of the present body
};

/// Solves with the tangent of a body whose bonds drop one after the other. A tangent K_0 is
/// linearised and factorised now and then. The stiffness that bonds have lost since then,
///
///   K = K_0 - G C G^T,   G the directions of the bonds, C their lost stiffness [N/m],
///
/// is subtracted by K^-1 = K_0^-1 + Z (C^-1 - G^T Z)^-1 Z^T, Z = K_0^-1 G (Woodbury), if the factor
/// is direct. K neglects the body's motion since the linearisation: this suffices for iterations
/// that evaluate the residual itself, and call `refresh` when they become slow. What they report of
/// their corrections is used again (KnownCorrections), until the next refresh. If a stored tangent
/// is not positive definite, a solver that accepts this is used instead.
class UpdatedTangent {
 public:
  /// The arguments outlive it. Nobody else may use solver and tangent without calling `forget`.
  UpdatedTangent(const EquilibriumProblem& problem, LinearSolver& solver, TangentOperator& tangent);
  ~UpdatedTangent();

  /// Linearises and factorises at a state. Contacts that may touch are found anew, so that nothing
  /// depends on earlier states.
  /// @param foreseen see StateView; a tangent with contacts that are foreseen can't be restored
  [[nodiscard]] LinearOutcome refresh(State at, std::span<const double> foreseen = {});
  /// Restores the tangent of a reference, to the last bit; forgets if that fails.
  void become(const TangentReference& reference);
  [[nodiscard]] const TangentReference& reference() const { return reference_; }
  /// The next solve then needs a refresh before it.
  void forget();
  [[nodiscard]] bool is_there() const { return is_there_; }
  /// True if the signs of pivots are known; iterations meet negative curvature only by chance.
  [[nodiscard]] bool tells_pivots() const {
    return solver_.inertia().has_value() || indefinite_in_force_;
  }
  /// True if the present tangent has the stiffness of contacts, which changes from state to state.
  [[nodiscard]] bool touches() const { return is_there_ && touches_; }
  /// True if the present tangent has negative pivots.
  [[nodiscard]] bool has_negative_pivots() const { return indefinite_in_force_; }
  /// Largest number of bonds whose loss is subtracted before the tangent is factorised anew: at
  /// this number the subtraction costs as much as the substitutions themselves.
  static constexpr int most_columns = 128;
  /// Number of refreshes; earlier solutions belong to other tangents.
  [[nodiscard]] int refreshed() const { return refreshed_; }

  /// Subtracts the stiffness that bonds have lost, or forgets if that does not pay.
  void lose(std::span<const LostStiffness> lost);

  /// Solves K_ff du_f = force_f with the present tangent and what is known.
  [[nodiscard]] LinearOutcome solve(std::span<const double> force, double tolerance,
                                    std::vector<double>& direction);
  /// Notes what a solution has changed of the residual.
  void learn(std::span<const double> solution, std::span<const double> change);
  /// Solves K_ff du_f = force_f - K_fp jump_p for a right-hand side that is often repeated: its
  /// solution is kept.
  /// @param jump of the prescribed displacements, zero elsewhere; empty for none
  [[nodiscard]] LinearOutcome solve_again(std::span<const double> force,
                                          std::span<const double> jump, double tolerance,
                                          std::vector<double>& direction);

  /// Tangent of the last linearisation.
  [[nodiscard]] const TangentOperator& tangent() const { return tangent_; }
  [[nodiscard]] int last_iterations() const { return present().last_iterations(); }

 private:
  struct Correction;

  [[nodiscard]] std::vector<double> right_hand_side(std::span<const double> force,
                                                    std::span<const double> jump) const;
  [[nodiscard]] LinearSolver& present() const {
    return indefinite_in_force_ ? *indefinite_ : solver_;
  }
  /// Changes to the solver that accepts negative pivots.
  [[nodiscard]] LinearOutcome take_indefinite();
  [[nodiscard]] LinearOutcome solve_for(std::span<const double> side, double tolerance,
                                        std::vector<double>& solution);
  /// Direction of a bond; points that follow others pass their part on to these.
  struct BondDirection {
    using Shares = std::vector<std::pair<Index, double>>;
    Shares free;  ///< by equation
    Shares held;  ///< by degree of freedom without an equation
  };
  [[nodiscard]] BondDirection direction_of(const LostStiffness& lost) const;
  [[nodiscard]] LinearOutcome add_column(const LostStiffness& lost);
  [[nodiscard]] bool is_worth_updating() const;

  const EquilibriumProblem problem_;
  LinearSolver& solver_;
  TangentOperator& tangent_;
  std::unique_ptr<Correction> correction_;
  std::unique_ptr<LinearSolver> indefinite_;
  TangentReference reference_;
  bool is_there_ = false, is_direct_ = false, indefinite_in_force_ = false, touches_ = false;
  int refreshed_ = 0;
};

}  // namespace peristat
