#pragma once

#include <memory>

#include "solvers/linear/preconditioner.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Aggregation with a rigid-body coarse space, in two levels: block Jacobi, and the exact solution
/// in the space of the rigid motions of small pieces of the body,
///
///   M^-1 = D^-1 + Q E^-1 Q^T,   E = Q^T K_ff Q,
///
/// Q an orthonormal basis of the translations and rotations of each piece about its centre in the
/// current configuration. Pieces are boxes some 5/3 of a horizon wide, each divided where no
/// unbroken bond joins it, so that a crack runs between pieces and never through one.
///
/// Motions that are smooth over a piece cost little energy, and block Jacobi reduces them slowly. Q
/// contains them, also those of slender bodies, cracked bodies and fragments. The rest varies
/// within a horizon, where the nonlocal K is close to its own diagonal. Iterations therefore depend
/// on neither the size nor the shape of a body: 30 to 50 to 1e-8. The method is two-level additive
/// Schwarz with a coarse space of aggregates' rigid motions (Nicolaides, SIAM J. Numer. Anal. 24,
/// 1987; Jönsthövel et al., Comput. Mech. 50, 2012).
///
/// A partitioned body has the pieces of the whole body: one may extend over several ranks, and rank
/// 0 stores E and its factor.
class RigidPieces : public Preconditioner {
 public:
  /// @param index_map of the body's points; it outlives this
  explicit RigidPieces(const IndexMap& index_map = whole_body());
  ~RigidPieces() override;

  void analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  /// A negative pivot of a diagonal block or of E shows that the tangent has one, too.
  [[nodiscard]] LinearOutcome build(const TangentOperator& tangent) override;
  void apply(std::span<const double> residual, std::span<double> correction) override;
  [[nodiscard]] std::string describe() const override;

 private:
  struct Levels;
  std::unique_ptr<Levels> levels_;
};

}  // namespace peristat
