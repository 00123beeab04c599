#pragma once

#include "assembly/assembler.hpp"
#include "assembly/tangent_operator.hpp"

namespace peristat {

/// Tangent of a model of bonds alone of which only the diagonal blocks are stored: products and
/// rows are computed anew from the bonds each time. The assembler outlives it, and its histories
/// must not change between a linearisation and the last use of it.
struct MatrixFreeTangent : TangentOperator {
  explicit MatrixFreeTangent(Assembler& assembler);

  [[nodiscard]] std::vector<double> positions() const override;
  void linearise(Assembler& assembler, std::span<const double> displacement,
                 double projection) override;
  void multiply(std::span<const double> v, std::span<double> result) const override;
  [[nodiscard]] bool multiplies_in_place() const override { return true; }
  void for_each_row(const RowVisitor& visit) const override;

 private:
  Assembler* assembler_;
  std::vector<double> displacement_;
  double projection_ = 0.0;
};

}  // namespace peristat
