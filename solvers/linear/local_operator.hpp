#pragma once

#include <limits>

#include "solvers/linear/lu_factor.hpp"
#include "solvers/linear/preconditioner.hpp"

namespace peristat {

/// M = the short-range stand-in of an unsymmetric tangent (UnsymmetricTangent::local_rows), by its
/// factors L U. Its long waves have the stiffness of K, so that the number of iterations hardly
/// depends on the size of the body. Not symmetric: for GMRES and BiCGStab.
class LocalOperator : public Preconditioner {
 public:
  /// @param most_bytes see LuFactor
  explicit LocalOperator(double most_bytes = std::numeric_limits<double>::infinity())
      : factor_(most_bytes) {}

  void analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  /// @return inaccurate where the stand-in is singular: K itself need not be
  /// @throws std::logic_error for a symmetric tangent
  [[nodiscard]] LinearOutcome build(const TangentOperator& tangent) override;
  void apply(std::span<const double> residual, std::span<double> correction) override;
  [[nodiscard]] std::string describe() const override { return "local operator"; }

  [[nodiscard]] const LuFactor& factor() const { return factor_; }

 private:
  LuFactor factor_;
  const FreeDofs* free_ = nullptr;
};

}  // namespace peristat
