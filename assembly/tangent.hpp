#pragma once

#include <span>
#include <vector>

#include "assembly/tangent_operator.hpp"

namespace peristat {

/// Tangent whose blocks are stored: the symmetric half.
struct Tangent : TangentOperator {
  Tangent(const Pattern& of, int dimension_of_points, int threads = 1);

  std::vector<double>
      off_diagonal;  ///< bonds x d x d, block (i, partner) in the order of the bonds

  void linearise(Assembler& assembler, std::span<const double> displacement,
                 double projection) override;
  void multiply(std::span<const double> v, std::span<double> result) const override;
  void for_each_row(const RowVisitor& visit) const override;
  [[nodiscard]] const Tangent* stored() const override { return this; }
  [[nodiscard]] Tangent* stored() override { return this; }

  /// Largest |K - K^T| over largest |K|. The off-diagonal blocks are stored once, so only diagonal
  /// blocks can be unsymmetric; whether an off-diagonal block is right in both its places is a
  /// matter of the derivative, which finite differences check.
  [[nodiscard]] double asymmetry() const;

  /// sqrt of the sum of squares of all entries, both halves counted [N/m].
  [[nodiscard]] double frobenius_norm() const;
};

}  // namespace peristat
