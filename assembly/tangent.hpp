#pragma once

#include <span>
#include <vector>

#include "assembly/pattern.hpp"

namespace peristat {

/// Tangent K = d2E/dx2 [N/m] of the stored energy over all degrees of freedom: the symmetric half,
/// in dimension x dimension blocks (row major). Block (j, i) is the transpose of block (i, j).
struct Tangent {
  Tangent(const Pattern& of, int dimension_of_points);

  Pattern pattern;
  int dimension;
  std::vector<double> diagonal;  ///< points x d x d
  std::vector<double>
      off_diagonal;  ///< bonds x d x d, block (i, partner) in the order of the bonds

  [[nodiscard]] Offset dofs() const { return Offset(pattern.points()) * dimension; }

  /// result = K v; both have one entry per degree of freedom and must not overlap.
  void multiply(std::span<const double> v, std::span<double> result) const;

  /// Sums of the absolute entries of each row, sum_j |K_ij| [N/m]: Gershgorin's bound of the
  /// largest eigenvalue, per degree of freedom.
  void absolute_row_sums(std::span<double> sums) const;

  /// Largest |K - K^T| over largest |K|. The off-diagonal blocks are stored once, so only diagonal
  /// blocks can be unsymmetric; whether an off-diagonal block is right in both its places is a
  /// matter of the derivative, which finite differences check.
  [[nodiscard]] double asymmetry() const;

  /// sqrt of the sum of squares of all entries, both halves counted [N/m].
  [[nodiscard]] double frobenius_norm() const;
};

}  // namespace peristat
