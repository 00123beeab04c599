#include "assembly/operators/matrix_free_tangent.hpp"

#include <stdexcept>

namespace peristat {

MatrixFreeTangent::MatrixFreeTangent(Energy& energy) : OperatorOfEnergy(energy, energy.pattern()) {
  if (energy.tangent_kind() != TangentKind::visited) {
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

}  // namespace peristat
