#include "assembly/operators/convolved_tangent.hpp"

#include <algorithm>
#include <stdexcept>

namespace peristat {

ConvolvedTangent::ConvolvedTangent(Energy& energy)
    : TangentOperator(energy.pattern(), energy.points().dimension, energy.threads()),
      energy_(&energy),
      row_sums_(energy.points().reference.size()) {}

std::vector<double> ConvolvedTangent::positions() const {
  return at_.positions(energy_->points().reference);
}

void ConvolvedTangent::linearise(Energy& energy, const StateView& at, double projection) {
  energy_ = &energy;
  reference = energy.points().reference;
  at_.keep(at);
  projection_ = projection;
  std::fill(diagonal.begin(), diagonal.end(), 0.0);
  std::fill(row_sums_.begin(), row_sums_.end(), 0.0);
  energy.outline_rows(at, diagonal, row_sums_);
}

void ConvolvedTangent::multiply(std::span<const double> v, std::span<double> result) const {
  energy_->product(at_.view(), v, result, projection_);
}

void ConvolvedTangent::for_each_row(const RowVisitor&) const {
  throw std::logic_error("a tangent by convolutions has no rows to visit");
}

void ConvolvedTangent::absolute_row_sums(std::span<double> sums) const {
  std::copy(row_sums_.begin(), row_sums_.end(), sums.begin());
}

bool ConvolvedTangent::is_symmetric() const { return energy_->has_potential(); }

LatticeStencil ConvolvedTangent::stencil() const { return energy_->stencil(at_.view()); }

}  // namespace peristat
