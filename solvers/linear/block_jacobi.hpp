#pragma once

#include <vector>

#include "solvers/linear/preconditioner.hpp"

namespace peristat {

/// M = the diagonal of K_ff, or its diagonal blocks, one per point; of an unsymmetric tangent their
/// symmetric parts.
class BlockJacobi : public Preconditioner {
 public:
  enum class Blocks { entries, points };
  explicit BlockJacobi(Blocks blocks) : blocks_(blocks) {}

  void analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  /// Negative or zero pivots of a diagonal block are the tangent's, too, if it is symmetric.
  [[nodiscard]] LinearOutcome build(const TangentOperator& tangent) override;
  void apply(std::span<const double> residual, std::span<double> correction) override;
  [[nodiscard]] std::string describe() const override;

  /// correction += scale M^-1 residual
  void add(double scale, std::span<const double> residual, std::span<double> correction) const;

 private:
  Blocks blocks_;
  const FreeDofs* free_ = nullptr;
  int threads_ = 1;
  /// Of each point, the upper half of the inverse block; rows and columns of prescribed degrees of
  /// freedom are zero.
  std::vector<double> inverse_;
};

}  // namespace peristat
