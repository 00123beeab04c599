#pragma once

#include <vector>

#include "assembly/operators/tangent.hpp"
#include "src/constraints/constraints.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Pattern of K_q: the points and handles that it couples if K has the pattern `whole`.
/// @param index_map partition of a distributed body: the pattern then has the rows of owned points
///        and of handles. Collective
[[nodiscard]] BlockPattern constrained_pattern(const BlockPattern& whole,
                                               const Constraints& constraints,
                                               const IndexMap& index_map = whole_body());

/// Tangent of a body with dependent degrees of freedom,
///
///   K_q = J^T K J + sum (dE/du - f) . d2 phi / dq2
///
/// over its points and generalised degrees of freedom (handles); rows of dependent ones are empty.
/// See Constraints.
///
/// On a part of a body the rows of owned points are the whole body's, with handles among the
/// columns; rank 0 has the blocks between handles. Rows of ghosts are meaningless. All calls are
/// collective.
class ConstrainedTangent final : public Tangent {
 public:
  /// All references must outlive it.
  /// @param index_map partition of a distributed body in which only images and rigid sets follow
  ///        others: what follows a rank's points is present on that rank. Null: the body is whole
  ConstrainedTangent(const Energy& energy, const Constraints& constraints,
                     const IndexMap& index_map = whole_body());

  /// See couplings_in_place.
  [[nodiscard]] Couplings in_place() const;
  void linearise(Energy& energy, const StateView& at, double projection) override;
  /// On a part, entries of v for ghosts are ignored.
  void multiply(std::span<const double> v, std::span<double> result) const override;
  void absolute_row_sums(std::span<double> sums) const override;

 private:
  void find_places();
  void add_blocks_between_free_points();
  void add_blocks_of_followers(std::span<const double> displacement);
  void add_curvature(const StateView& at);
  /// Masters of a point of K, and whether this rank adds the point's row of K.
  struct End {
    const std::vector<Dependence>& masters;
    bool is_owned;
  };
  /// Adds J_a^T block J_b over the dependences of two points, and its transpose unless they are one
  /// point.
  void add_reduced(const End& a, const End& b, const Tensor& block, bool is_diagonal);
  void add(Index row, Index column, const Tensor& block);
  /// Replaces blocks between handles, of which each rank has a share, by their sums at rank 0.
  /// Collective.
  void gather_handles();

  const Points& points_;
  const Constraints& constraints_;
  const IndexMap& index_map_;
  Tangent whole_;                       ///< K, of the body's points
  std::vector<Offset> place_;           ///< per block of K: its position here; -1: none
  std::vector<double> reference_;       ///< of points and handles
  mutable std::vector<double> factor_;  ///< on a part: v with the values of ghosts and handles
};

/// Couplings in K of all points but images, at their own positions; partners may be images. K_q
/// also couples points across a period, and with handles, which have no position.
[[nodiscard]] Couplings couplings_in_place(const TangentOperator& tangent);

}  // namespace peristat
