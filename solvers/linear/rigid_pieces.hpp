#pragma once

#include <memory>

#include "assembly/energy/sharing.hpp"
#include "solvers/linear/preconditioner.hpp"

namespace peristat {

/// Two levels: block Jacobi, and the exact solution in the space of the rigid motions of small
/// pieces of the body,
///
///   M^-1 = D^-1 + Q E^-1 Q^T,   E = Q^T K_ff Q,
///
/// Q an orthonormal basis of the motions, the translations and rotations of each piece about its
/// centre in the current configuration. Pieces are boxes some 5/3 of a horizon wide, each divided
/// where no unbroken bond joins it, so that a crack runs between pieces and never through one.
///
/// Motions that are smooth over a piece cost little energy and are what block Jacobi is slow at; Q
/// holds them, those of slender bodies, cracked bodies and fragments as well. What is left varies
/// within a horizon, where the nonlocal K is about its own diagonal. Iterations therefore depend on
/// neither the size nor the shape of a body: 30 to 50 to 1e-8. The method is two-level additive
/// Schwarz with a coarse space of aggregates' rigid motions (Nicolaides, SIAM J. Numer. Anal. 24,
/// 1987; Jönsthövel et al., Comput. Mech. 50, 2012).
///
/// Pieces of a body on several ranks are those of the whole: they may stand on several of them, and
/// rank 0 has E and its factor.
class RigidPieces : public Preconditioner {
 public:
  /// @param sharing of a part of a body, which outlives it; null: the body is whole
  explicit RigidPieces(const Sharing* sharing = nullptr);
  ~RigidPieces() override;

  void analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  /// Negative pivots of a diagonal block or of E are the tangent's, too.
  [[nodiscard]] LinearOutcome build(const TangentOperator& tangent) override;
  void apply(std::span<const double> residual, std::span<double> correction) override;
  [[nodiscard]] std::string describe() const override;

 private:
  struct Levels;
  std::unique_ptr<Levels> levels_;
};

}  // namespace peristat
