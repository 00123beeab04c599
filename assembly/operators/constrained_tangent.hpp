#pragma once

#include <vector>

#include "assembly/operators/tangent.hpp"
#include "src/constraints/constraints.hpp"
#include "src/core/sharing.hpp"

namespace peristat {

/// Which points and handles K_q couples where K couples these points.
/// @param sharing of a part of a body: in the rows of owned points and of handles. A call that all
///        ranks make
[[nodiscard]] BlockPattern constrained_pattern(const BlockPattern& whole,
                                               const Constraints& constraints,
                                               const Sharing* sharing = nullptr);

/// Tangent of a body whose degrees of freedom follow others,
///
///   K_q = J^T K J + sum (dE/du - f) . d2 phi / dq2
///
/// over its points and handles; rows of what follows are empty. See Constraints.
///
/// Of a part of a body the rows of owned points are the whole body's, with handles for columns;
/// rank 0 has the blocks between handles. Rows of ghosts mean nothing. All ranks make the same
/// calls.
class ConstrainedTangent final : public Tangent {
 public:
  /// All outlive it.
  /// @param sharing of a part of a body whose images and rigid sets alone follow: what follows its
  ///        rank's points is there, too. Null: the body is whole
  ConstrainedTangent(const Energy& energy, const Constraints& constraints,
                     const Sharing* sharing = nullptr);

  /// See couplings_in_place.
  [[nodiscard]] Couplings in_place() const;
  void linearise(Energy& energy, const StateView& at, double projection) override;
  /// Of a part, what v has for ghosts does not count.
  void multiply(std::span<const double> v, std::span<double> result) const override;
  void absolute_row_sums(std::span<double> sums) const override;

 private:
  void add_blocks_between_free_points();
  void add_blocks_of_followers(std::span<const double> displacement);
  void add_curvature(const StateView& at);
  /// What a point of K follows, and whether its row of K is this rank's to add.
  struct End {
    const std::vector<Dependence>& masters;
    bool is_owned;
  };
  /// Adds J_a^T block J_b over the dependences of two points, and unless they are one point, its
  /// transpose.
  void add_reduced(const End& a, const End& b, const Tensor& block, bool is_diagonal);
  void add(Index row, Index column, const Tensor& block);
  /// Replaces blocks between handles, of which each rank has a share, by their sums at rank 0.
  void gather_handles();

  const Points& points_;
  const Constraints& constraints_;
  const Sharing* sharing_;
  Tangent whole_;                  ///< K, of the body's points
  std::vector<Offset> place_;      ///< per block of K: its block here; -1 where a point follows
  std::vector<double> reference_;  ///< of points and handles
  mutable std::vector<double> factor_;  ///< of a part, with what ghosts and handles have
};

/// Couplings in K of the points that stand for themselves, where they stand; images may be their
/// partners. K_q couples points over a period, too, and with handles, which stand nowhere.
[[nodiscard]] Couplings couplings_in_place(const TangentOperator& tangent);

}  // namespace peristat
