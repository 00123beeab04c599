#include "assembly/operators/rows_of_energy.hpp"

#include <algorithm>
#include <stdexcept>

namespace peristat {

RowsOfEnergy::RowsOfEnergy(Energy& energy)
    : UnsymmetricTangent(BlockPattern::diagonal(energy.points().count()), energy.points().dimension,
                         energy.threads()),
      energy_(&energy),
      row_sums_(energy.points().reference.size()) {
  if (energy.tangent_kind() != TangentKind::rows) {
    throw std::logic_error("the tangent of this energy is not made of rows");
  }
}

std::vector<double> RowsOfEnergy::positions() const {
  return at_.positions(energy_->points().reference);
}

void RowsOfEnergy::linearise(Energy& energy, const StateView& at, double /*projection*/) {
  energy_ = &energy;
  reference = energy.points().reference;
  at_.keep(at);
  std::ranges::fill(diagonal, 0.0);
  std::ranges::fill(row_sums_, 0.0);
  energy.forms().rows->outline(at, diagonal, row_sums_);
}

void RowsOfEnergy::multiply(std::span<const double> v, std::span<double> result) const {
  energy_->product(at_.view(), v, result, 0.0);
}

void RowsOfEnergy::for_each_row(const RowVisitor&) const {
  throw std::logic_error("rows of an unsymmetric tangent are no halves of a symmetric one");
}

void RowsOfEnergy::absolute_row_sums(std::span<double> sums) const {
  std::copy(row_sums_.begin(), row_sums_.end(), sums.begin());
}

SparseRows RowsOfEnergy::rows() const {
  return energy_->forms().rows->rows(at_.view(), RowReach::whole);
}

SparseRows RowsOfEnergy::local_rows() const {
  return energy_->forms().rows->rows(at_.view(), RowReach::local);
}

}  // namespace peristat
