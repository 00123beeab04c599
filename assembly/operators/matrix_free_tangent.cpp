#include "assembly/operators/matrix_free_tangent.hpp"

#include <stdexcept>

namespace peristat {

MatrixFreeTangent::MatrixFreeTangent(Energy& energy) : OperatorOfEnergy(energy, energy.pattern()) {
  if (!energy.forms().visits) {
    throw std::logic_error("the tangent of this energy must be stored");
  }
}

void MatrixFreeTangent::linearise(Energy& energy, const StateView& at, double projection) {
  keep(energy, at, projection);
  energy.forms().visits->visit_tangent(
      at, projection, [](int, Index, std::span<const double>) {}, diagonal);
}

void MatrixFreeTangent::for_each_row(const RowVisitor& visit) const {
  energy_->forms().visits->visit_tangent(at_.view(), projection_, visit, {});
}

void MatrixFreeTangent::absolute_row_sums(std::span<double> sums) const {
  TangentOperator::absolute_row_sums(sums);
  const double factor = energy_->forms().visits->most_over_visited();
  for (double& sum : sums) sum *= factor;
}

}  // namespace peristat
