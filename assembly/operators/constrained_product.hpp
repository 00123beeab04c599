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
  /// Of a K without rows numbers that are not less: |J|^T |K| |J| of ones.
  void absolute_row_sums(std::span<double> sums) const override;
  [[nodiscard]] bool is_symmetric() const override { return whole_->is_symmetric(); }

 private:
  /// Adds J_i^T block J_j to the diagonal block of each point or handle that both follow.
  void add_to_diagonal(const std::vector<Dependence>& of_i, const Tensor& block,
                       const std::vector<Dependence>& of_j);
  /// Blocks of K between two points that follow the same.
  void add_blocks_between_followers();
  /// A block of K_q, or a share of it.
  struct Block {
    Index row = 0, column = 0;
    Tensor entries{};
  };
  /// Per point or handle, whether its row is a sum of blocks of what follows.
  [[nodiscard]] std::vector<char> merged_rows() const;
  /// Shares of the blocks of such rows that the rank owns, and of those between two handles.
  [[nodiscard]] std::vector<Block> merged_blocks(const std::vector<char>& is_merged) const;
  /// Shares of one block are added up; by rows and columns.
  [[nodiscard]] static std::vector<Block> added_up(std::vector<Block> blocks);
  /// Those between handles that all ranks have.
  [[nodiscard]] std::vector<Block> of_all(const std::vector<Block>& mine) const;
  /// Makes sums over rows of K those over rows of K_q.
  void replace_merged_rows(std::span<double> sums) const;
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
