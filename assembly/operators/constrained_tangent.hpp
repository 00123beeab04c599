#pragma once

#include <vector>

#include "assembly/operators/tangent.hpp"
#include "src/constraints/constraints.hpp"

namespace peristat {

/// Which points and handles K_q couples where K couples these points.
[[nodiscard]] BlockPattern constrained_pattern(const BlockPattern& whole,
                                               const Constraints& constraints);

/// Tangent of a body whose degrees of freedom follow others,
///
///   K_q = J^T K J + sum (dE/du - f) . d2 phi / dq2
///
/// over its points and handles; rows of what follows are empty. See Constraints.
class ConstrainedTangent final : public Tangent {
 public:
  /// Both outlive it.
  ConstrainedTangent(const Energy& energy, const Constraints& constraints);

  void linearise(Energy& energy, const StateView& at, double projection) override;

 private:
  void add_blocks_between_free_points();
  void add_blocks_of_followers(std::span<const double> displacement);
  void add_curvature(const StateView& at);
  /// Adds J_a^T block J_b over the dependences of two points, and unless they are one point, its
  /// transpose.
  void add_reduced(const std::vector<Dependence>& a, const std::vector<Dependence>& b,
                   const Tensor& block, bool is_diagonal);
  void add(Index row, Index column, const Tensor& block);

  const Constraints& constraints_;
  Tangent whole_;                  ///< K, of the body's points
  std::vector<Offset> place_;      ///< per block of K: its block here; -1 where a point follows
  std::vector<double> reference_;  ///< of points and handles
};

}  // namespace peristat
