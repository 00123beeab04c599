#pragma once

#include <vector>

#include "solvers/linear/preconditioner.hpp"

namespace peristat {

/// M = the diagonal of K_ff, or its diagonal blocks, one per point; for an unsymmetric tangent, the
/// symmetric parts of the blocks.
class BlockJacobi : public Preconditioner {
 public:
  enum class Blocks { entries, points };
  explicit BlockJacobi(Blocks blocks) : blocks_(blocks) {}

  void analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  /// A negative or zero pivot of a diagonal block shows that a symmetric tangent has one, too.
  [[nodiscard]] LinearOutcome build(const TangentOperator& tangent) override;
  void apply(std::span<const double> residual, std::span<double> correction) override;
  [[nodiscard]] std::string describe() const override;

  /// correction += scale M^-1 residual
  void add(double scale, std::span<const double> residual, std::span<double> correction) const;

 private:
  Blocks blocks_;
  const FreeDofs* free_ = nullptr;
  int threads_ = 1;
  /// Per point: upper half of the inverse block; rows and columns of prescribed degrees of freedom
  /// are zero.
  std::vector<double> inverse_;
};

}  // namespace peristat
