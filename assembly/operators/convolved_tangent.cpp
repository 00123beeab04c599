#include "assembly/operators/convolved_tangent.hpp"

#include <algorithm>
#include <stdexcept>

#include "assembly/energy/tangent_forms.hpp"

namespace peristat {

ConvolvedTangent::ConvolvedTangent(Energy& energy)
    : TangentOperator(energy.pattern(), energy.points().dimension, energy.threads()),
      energy_(&energy) {
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

std::vector<double> ConvolvedTangent::positions() const {
  return at_.positions(energy_->points().reference);
}

void ConvolvedTangent::linearise(Energy& energy, const StateView& at, double projection) {
  energy_ = &energy;
  reference = energy.points().reference;
  at_.keep(at);
  projection_ = projection;
  diagonal.assign(reference.size() * std::size_t(dimension), 0.0);
  std::vector<double> unused(energy.points().reference.size());
  energy.forms().products->outline(at, diagonal, unused);
}

void ConvolvedTangent::multiply(std::span<const double> v, std::span<double> result) const {
  energy_->product(at_.view(), v, result, projection_);
}

void ConvolvedTangent::for_each_row(const RowVisitor&) const {
  throw std::logic_error("a tangent by convolutions has no rows to visit");
}

void ConvolvedTangent::absolute_row_sums(std::span<double> sums) const {
  std::vector<double> unused(diagonal.size());
  std::fill(sums.begin(), sums.end(), 0.0);
  energy_->forms().products->outline(at_.view(), unused, sums);
}

bool ConvolvedTangent::is_symmetric() const { return energy_->has_potential(); }

LatticeStencil ConvolvedTangent::stencil() const {
  return energy_->forms().products->stencil(at_.view());
}

}  // namespace peristat
