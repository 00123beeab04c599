#pragma once

#include <memory>
#include <vector>

#include "assembly/operators/tangent_operator.hpp"
#include "src/constraints/constraints.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Tangent of a body with dependent degrees of freedom, for a K that has products alone, or that is
/// distributed over ranks,
///
///   K_q = J^T K J + sum (dE/du - f) . d2 phi / dq2
///
/// over its points and generalised degrees of freedom (handles), see Constraints;
/// ConstrainedTangent is its counterpart with stored blocks. Entries of dependent degrees of
/// freedom are 0. On a part of a body rank 0 has the rows of handles.
struct ConstrainedProduct final : TangentOperator {
  /// All references must outlive it.
  /// @param whole K, of the body's points
  /// @param index_map partition of a distributed body: ghosts and their images have no rows of K,
  /// and
  ///        all calls are collective. Null: the body is whole
  ConstrainedProduct(std::unique_ptr<TangentOperator> whole, const Points& points,
                     const Constraints& constraints, const IndexMap& index_map = whole_body());

  [[nodiscard]] std::vector<double> positions() const override;
  void linearise(Energy& energy, const StateView& at, double projection) override;
  void multiply(std::span<const double> v, std::span<double> result) const override;
  [[nodiscard]] bool multiplies_in_single() const override {
    return whole_->multiplies_in_single();
  }
  void multiply_in_single(std::span<const double> v, std::span<double> result) const override;
  /// True if K has rows; those of K_q can't be visited.
  [[nodiscard]] bool has_rows() const override { return whole_->has_rows(); }
  /// @throws std::logic_error
  void for_each_row(const RowVisitor& visit) const override;
  /// Upper bounds, see bound_constrained_row_sums.
  void absolute_row_sums(std::span<double> sums) const override;
  [[nodiscard]] bool is_symmetric() const override { return whole_->is_symmetric(); }

 private:
  /// J^T multiply(J v) and the rest of K_q.
  template <class Multiply>
  void multiply_by(const Multiply& multiply, std::span<const double> v,
                   std::span<double> result) const;

  /// A block of K between two points that follow masters of several ranks: the numbers of both
  /// followers, and the block times the points' factors (see SharedDependence).
  struct SharedBlock {
    std::size_t i, j;
    Tensor block;
  };

  /// Adds J_i^T block J_j to the diagonal block of each master (point or handle) that both follow.
  void add_to_diagonal(const std::vector<Dependence>& of_i, const Tensor& block,
                       const std::vector<Dependence>& of_j);
  /// Adds a block of a row of K, i a point that this rank owns; blocks between shared followers are
  /// collected in `shared`.
  void add_block(Index i, const Tensor& block, Index j, std::vector<SharedBlock>& shared);
  /// Adds the blocks between shared followers of all ranks. Collective.
  void add_shared_blocks(const std::vector<SharedBlock>& mine);
  /// Adds the blocks of K between two points that follow the same masters.
  void add_blocks_between_followers(std::vector<SharedBlock>& shared);
  /// Replaces entries of handles, of which each rank has a share, by their sums. Collective.
  void sum_handles(std::span<double> of_dofs) const;

  std::unique_ptr<TangentOperator> whole_;
  const Points& points_;
  const Constraints& constraints_;
  const IndexMap& index_map_;
  std::vector<double> reference_;     // of points and handles
  std::vector<double> displacement_;  // at which K is linearised
  std::vector<Tensor> curvature_;     // of rigid sets
  std::vector<double> no_force_;
  mutable std::vector<double> moved_;  // J v
};

/// Tangent of a body whose forces are found by convolutions.
[[nodiscard]] std::unique_ptr<TangentOperator> make_convolved_tangent(
    Energy& energy, const Constraints& constraints);

}  // namespace peristat
