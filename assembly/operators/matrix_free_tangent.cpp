#include "assembly/operators/matrix_free_tangent.hpp"

#include <stdexcept>

namespace peristat {

MatrixFreeTangent::MatrixFreeTangent(Energy& energy, Precision precision)
    : OperatorOfEnergy(energy, energy.pattern()), precision_(precision) {
  if (!energy.forms().visits) {
    throw std::logic_error("the tangent of this energy must be stored");
  }
}

void MatrixFreeTangent::linearise(Energy& energy, const StateView& at, double projection) {
  keep(energy, at, projection);
  energy.forms().visits->find_diagonal(at, projection, diagonal);
}

bool MatrixFreeTangent::multiplies_in_single() const {
  return precision_ == Precision::single && energy_->has_single_products();
}

void MatrixFreeTangent::multiply_in_single(std::span<const double> v,
                                           std::span<double> result) const {
  StateView at = at_.view();
  at.precision = precision_;
  energy_->product(at, v, result, projection_);
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
