#pragma once

#include <memory>
#include <vector>

#include "assembly/operators/tangent_operator.hpp"
#include "src/constraints/constraints.hpp"
#include "src/core/sharing.hpp"

namespace peristat {

/// Tangent of a body whose degrees of freedom follow others, where K has products alone, or ranks
/// have parts of it,
///
///   K_q = J^T K J + sum (dE/du - f) . d2 phi / dq2
///
/// over its points and handles, see Constraints: what ConstrainedTangent is of blocks. Entries of
/// what follows are 0. Of a part of a body rank 0 has the rows of handles.
struct ConstrainedProduct final : TangentOperator {
  /// All outlive it.
  /// @param whole K, of the body's points
  /// @param sharing of a part of a body, whose ghosts and their images have no rows of K; all ranks
  ///        make the same calls. Null: the body is whole
  ConstrainedProduct(std::unique_ptr<TangentOperator> whole, const Points& points,
                     const Constraints& constraints, const Sharing* sharing = nullptr);

  [[nodiscard]] std::vector<double> positions() const override;
  void linearise(Energy& energy, const StateView& at, double projection) override;
  void multiply(std::span<const double> v, std::span<double> result) const override;
  /// Of K: those of K_q can't be visited.
  [[nodiscard]] bool has_rows() const override { return whole_->has_rows(); }
  /// @throws std::logic_error
  void for_each_row(const RowVisitor& visit) const override;
  /// Numbers that are not less: see bound_constrained_row_sums.
  void absolute_row_sums(std::span<double> sums) const override;
  [[nodiscard]] bool is_symmetric() const override { return whole_->is_symmetric(); }

 private:
  /// A block of K between two points of which masters of several ranks follow: numbers of these
  /// followers, and what they have of the points.
  struct SharedBlock {
    std::size_t i, j;
    Tensor block;
  };

  /// Adds J_i^T block J_j to the diagonal block of each point or handle that both follow.
  void add_to_diagonal(const std::vector<Dependence>& of_i, const Tensor& block,
                       const std::vector<Dependence>& of_j);
  /// Adds what a row of K has: of a point that this rank owns, and perhaps of others.
  void add_block(Index i, const Tensor& block, Index j, std::vector<SharedBlock>& shared);
  /// Adds blocks between shared followers, those of all ranks.
  void add_shared_blocks(const std::vector<SharedBlock>& mine);
  /// Blocks of K between two points that follow the same.
  void add_blocks_between_followers(std::vector<SharedBlock>& shared);
  /// Replaces entries of handles, of which each rank has a share, by their sums.
  void sum_handles(std::span<double> of_dofs) const;

  std::unique_ptr<TangentOperator> whole_;
  const Points& points_;
  const Constraints& constraints_;
  const Sharing* sharing_;
  std::vector<double> reference_;     // of points and handles
  std::vector<double> displacement_;  // where K is
  std::vector<Tensor> curvature_;     // of rigid sets
  std::vector<double> no_force_;
  mutable std::vector<double> moved_;  // J v
};

/// Tangent of a body whose forces are found by convolutions.
[[nodiscard]] std::unique_ptr<TangentOperator> make_convolved_tangent(
    Energy& energy, const Constraints& constraints);

}  // namespace peristat
