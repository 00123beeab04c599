#include "assembly/operators/matrix_free_tangent.hpp"

#include <stdexcept>

namespace peristat {

MatrixFreeTangent::MatrixFreeTangent(Energy& energy)
    : TangentOperator(energy.pattern(), energy.points().dimension, energy.threads()),
      energy_(&energy) {
  if (energy.tangent_kind() != TangentKind::visited) {
    throw std::logic_error("the tangent of this energy must be stored");
  }
}

std::vector<double> MatrixFreeTangent::positions() const {
  return at_.positions(energy_->points().reference);
}

void MatrixFreeTangent::linearise(Energy& energy, const StateView& at, double projection) {
  energy_ = &energy;
  reference = energy.points().reference;
  at_.keep(at);
  projection_ = projection;
  energy.forms().visits->visit_tangent(
      at, projection, [](int, Index, std::span<const double>) {}, diagonal);
}

void MatrixFreeTangent::multiply(std::span<const double> v, std::span<double> result) const {
  energy_->product(at_.view(), v, result, projection_);
}

void MatrixFreeTangent::for_each_row(const RowVisitor& visit) const {
  energy_->forms().visits->visit_tangent(at_.view(), projection_, visit, {});
}

}  // namespace peristat
