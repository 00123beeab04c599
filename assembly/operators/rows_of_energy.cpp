#include "assembly/operators/rows_of_energy.hpp"

#include <algorithm>

namespace peristat {

RowsOfEnergy::RowsOfEnergy(Energy& energy)
    : UnsymmetricTangent(BlockPattern::diagonal(energy.points().count()), energy.points().dimension,
                         energy.threads()),
      energy_(&energy),
      row_sums_(energy.points().reference.size()) {}

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
