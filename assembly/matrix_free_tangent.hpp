#pragma once

#include "assembly/assembler.hpp"
#include "assembly/tangent_operator.hpp"

namespace peristat {

/// Tangent of a model of bonds alone of which only the diagonal blocks are stored: products and
/// rows are computed anew from the bonds each time. The assembler outlives it.
struct MatrixFreeTangent : TangentOperator {
  explicit MatrixFreeTangent(Assembler& assembler);

  [[nodiscard]] std::vector<double> positions() const override;
  void linearise(Assembler& assembler, const StateView& at, double projection) override;
  void multiply(std::span<const double> v, std::span<double> result) const override;
  [[nodiscard]] bool multiplies_in_place() const override { return true; }
  void for_each_row(const RowVisitor& visit) const override;

 private:
  [[nodiscard]] StateView at() const { return {displacement_, history_, damage_}; }

  Assembler* assembler_;
  std::vector<double> displacement_;
  History history_;
  Damage damage_ = Damage::grows;
  double projection_ = 0.0;
};

}  // namespace peristat
