#pragma once

#include <limits>
#include <memory>

#include "assembly/operators/tangent.hpp"
#include "solvers/linear/cholesky.hpp"
#include "solvers/linear/lu_factor.hpp"
#include "solvers/linear/preconditioner.hpp"

namespace peristat {

/// M = a short-range approximation of an unsymmetric tangent (UnsymmetricTangent::local_rows). It
/// has the stiffness of K for long waves, so that the number of iterations hardly depends on the
/// size of the body.
///
/// If the approximation is nearly symmetric, its symmetric part is factorised as L L^T, on all
/// threads and with half of the entries. Otherwise, and if that part is not positive definite, the
/// approximation itself is factorised as L U. For GMRES and BiCGStab.
class LocalOperator : public Preconditioner {
 public:
  /// @param most_bytes limit for matrix and factors
  explicit LocalOperator(double most_bytes = std::numeric_limits<double>::infinity())
      : most_bytes_(most_bytes), factor_(most_bytes) {}

  void analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  /// @return inaccurate if the approximation is singular: K itself need not be
  /// @throws std::logic_error for a symmetric tangent
  [[nodiscard]] LinearOutcome build(const TangentOperator& tangent) override;
  void apply(std::span<const double> residual, std::span<double> correction) override;
  [[nodiscard]] std::string describe() const override { return "local operator"; }

  [[nodiscard]] const LuFactor& factor() const { return factor_; }
  /// True if the symmetric part is factorised.
  [[nodiscard]] bool is_symmetric() const { return cholesky_ != nullptr; }

 private:
  LinearOutcome build_symmetric(const SparseRows& rows, int dimension, int threads);

  double most_bytes_;
  LuFactor factor_;
  std::unique_ptr<Tangent> symmetric_;  // the symmetric part
  std::unique_ptr<Cholesky> cholesky_;  // null: L U
  const FreeDofs* free_ = nullptr;
};

}  // namespace peristat
