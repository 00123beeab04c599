#include "assembly/operators/rows_of_energy.hpp"

#include <algorithm>

namespace peristat {

RowsOfEnergy::RowsOfEnergy(Energy& energy)
    : OperatorOfEnergy(energy, BlockPattern::diagonal(energy.points().count())),
      row_sums_(energy.points().reference.size()) {}

void RowsOfEnergy::linearise(Energy& energy, const StateView& at, double /*projection*/) {
  keep(energy, at, 0.0);
  std::ranges::fill(diagonal, 0.0);
  std::ranges::fill(row_sums_, 0.0);
  energy.forms().rows->outline(at, diagonal, row_sums_);
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
