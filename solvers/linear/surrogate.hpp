#pragma once

#include <memory>

#include "solvers/linear/preconditioner.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Approximation with a short horizon: springs along the bonds to the nearest neighbours alone (2
/// in 1D, 8 on a square lattice, 18 on a cubic one), with the block Jacobi preconditioner added,
///
///   M^-1 = S^-1 + D^-1 / 2,   S = sum over short bonds of gamma k n n^T,
///
/// k = max(-n.K_ij n, 0) the bond's own stiffness in the tangent and n its current direction, so
/// that S is positive semidefinite, invariant under rotations, and cut by the same cracks. The
/// factor gamma makes its second moment, sum k l^2, equal to that of all bonds: long waves then
/// meet the body's stiffness. For short waves S is several times stiffer than K, the more the
/// longer the horizon; there K is close to its own diagonal, and D^-1 / 2 fills the gap. The
/// condition number depends on neither size nor shape: 12 to 16 iterations to 1e-8.
///
/// S is factorised by Cholesky, some ten times cheaper than K. If that is still more than a few
/// seconds' work (3D bodies from some 35^3 points), and on several ranks, a multigrid cycle
/// replaces S^-1.
class Surrogate : public Preconditioner {
 public:
  /// @param index_map of the body's points; it outlives this
  explicit Surrogate(const IndexMap& index_map = whole_body());
  ~Surrogate() override;

  void analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  /// A negative pivot of a diagonal block shows that the tangent has one, too.
  /// @return also inaccurate if S is singular, since the tangent need not be: short bonds are
  ///         broken and long ones are not
  [[nodiscard]] LinearOutcome build(const TangentOperator& tangent) override;
  void apply(std::span<const double> residual, std::span<double> correction) override;
  [[nodiscard]] std::string describe() const override;

 private:
  struct StandIn;
  std::unique_ptr<StandIn> stand_in_;
};

}  // namespace peristat
