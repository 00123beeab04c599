#pragma once

#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "assembly/terms/bonds/borne_stretches.hpp"
#include "solvers/linear/linear_solver.hpp"
#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// What an UpdatedTangent is made from: a value.
struct TangentReference {
  State at;  ///< where it was linearised; without displacements: nowhere yet
  std::vector<LostStiffness> lost{};  ///< since
};

/// Solves with the tangent of a body whose bonds drop one after the other. A tangent K_0 is
/// linearised and factorised now and then; between, the stiffness that bonds have lost since,
///
///   K = K_0 - G C G^T,   G the directions of the bonds, C their lost stiffness [N/m],
///
/// is taken off by K^-1 = K_0^-1 + Z (C^-1 - G^T Z)^-1 Z^T, Z = K_0^-1 G (Woodbury), where
/// factors are direct. By how far the body has moved since, K is off: enough for iterations that
/// judge the residual itself, which `refresh` where they become slow. Where a stored tangent is not
/// positive definite, a solver that bears that takes its place.
class UpdatedTangent {
 public:
  /// All outlive it, and nobody else may use solver and tangent, unless it is told to `forget`.
  UpdatedTangent(const EquilibriumProblem& problem, LinearSolver& solver, TangentOperator& tangent);
  ~UpdatedTangent();

  /// Linearises and factorises at a state.
  [[nodiscard]] LinearOutcome refresh(State at);
  /// Becomes what another has been, to the last bit; forgets where that fails.
  void become(const TangentReference& reference);
  [[nodiscard]] const TangentReference& reference() const { return reference_; }
  /// The next solve has to be after a refresh.
  void forget();
  [[nodiscard]] bool is_there() const { return is_there_; }
  /// Whether pivots are seen; iterations only come upon negative curvature by chance.
  [[nodiscard]] bool tells_pivots() const {
    return solver_.inertia().has_value() || indefinite_in_force_;
  }
  /// Of the last refresh.
  [[nodiscard]] bool has_negative_pivots() const { return indefinite_in_force_; }
  /// Bonds whose loss is taken off before the tangent is factorised anew: then taking it off costs
  /// as much as the substitutions themselves.
  static constexpr int most_columns = 128;
  /// How often it was refreshed: what was solved before is of another tangent.
  [[nodiscard]] int refreshed() const { return refreshed_; }

  /// Takes off what bonds have lost, or forgets where that does not pay.
  void lose(std::span<const LostStiffness> lost);

  /// K_ff du_f = force_f - K_fp jump_p, by the tangent that is there.
  /// @param jump of the prescribed displacements, zero elsewhere; empty for none
  [[nodiscard]] LinearOutcome solve(std::span<const double> force, std::span<const double> jump,
                                    double tolerance, std::vector<double>& direction);
  /// Likewise, of a right-hand side that is often the same.
  [[nodiscard]] LinearOutcome solve_again(std::span<const double> force,
                                          std::span<const double> jump, double tolerance,
                                          std::vector<double>& direction);

  /// Linearised last.
  [[nodiscard]] const TangentOperator& tangent() const { return tangent_; }
  [[nodiscard]] int last_iterations() const { return present().last_iterations(); }

 private:
  struct Correction;

  [[nodiscard]] std::vector<double> right_hand_side(std::span<const double> force,
                                                    std::span<const double> jump) const;
  [[nodiscard]] LinearSolver& present() const {
    return indefinite_in_force_ ? *indefinite_ : solver_;
  }
  /// By the solver that bears negative pivots.
  [[nodiscard]] LinearOutcome take_indefinite();
  [[nodiscard]] LinearOutcome solve_for(std::span<const double> side, double tolerance,
                                        std::vector<double>& solution);
  /// Of a bond: what follows others hands its share on to them.
  struct BondDirection {
    using Shares = std::vector<std::pair<Index, double>>;
    Shares free;  ///< by equation
    Shares held;  ///< by degree of freedom that has none
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
  bool is_there_ = false, is_direct_ = false, indefinite_in_force_ = false;
  int refreshed_ = 0;
};

}  // namespace peristat
