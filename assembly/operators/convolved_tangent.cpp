#include "assembly/operators/convolved_tangent.hpp"

#include <algorithm>
#include <stdexcept>

namespace peristat {

ConvolvedTangent::ConvolvedTangent(Energy& energy) : OperatorOfEnergy(energy, energy.pattern()) {
  forget();
}

bool forget_if_convolved(TangentOperator& tangent) {
  auto* const convolved = dynamic_cast<ConvolvedTangent*>(&tangent);
  if (convolved != nullptr) convolved->forget();
  return convolved != nullptr;
}

void ConvolvedTangent::forget() {
  diagonal = std::vector<double>();
  at_ = {};
}

void ConvolvedTangent::linearise(Energy& energy, const StateView& at, double projection) {
  keep(energy, at, projection);
  diagonal.assign(reference.size() * std::size_t(dimension), 0.0);
  std::vector<double> unused(reference.size());
  energy.forms().products->outline(at, diagonal, unused);
}

void ConvolvedTangent::for_each_row(const RowVisitor&) const {
  throw std::logic_error("a tangent by convolutions has no rows to visit");
}

void ConvolvedTangent::absolute_row_sums(std::span<double> sums) const {
  std::vector<double> unused(diagonal.size());
  std::fill(sums.begin(), sums.end(), 0.0);
  energy_->forms().products->outline(at_.view(), unused, sums);
}

LatticeStencil ConvolvedTangent::stencil() const {
  return energy_->forms().products->stencil(at_.view());
}

}  // namespace peristat
