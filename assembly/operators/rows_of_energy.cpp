#include "assembly/operators/rows_of_energy.hpp"

#include <algorithm>
#include <stdexcept>

namespace peristat {
namespace {

BlockPattern no_blocks(Index points) {
  return BlockPattern::of_rows(std::vector<Offset>(std::size_t(points) + 1, 0),
                               std::vector<Index>());
}

}  // namespace

RowsOfEnergy::RowsOfEnergy(Energy& energy)
    : UnsymmetricTangent(no_blocks(energy.points().count()), energy.points().dimension,
                         energy.threads()),
      energy_(&energy),
      row_sums_(energy.points().reference.size()) {
  if (energy.has_potential()) throw std::logic_error("an energy has a symmetric tangent");
}

std::vector<double> RowsOfEnergy::positions() const {
  std::vector<double> current = energy_->points().reference;
  for (std::size_t k = 0; k < displacement_.size(); ++k) current[k] += displacement_[k];
  return current;
}

void RowsOfEnergy::linearise(Energy& energy, const StateView& at, double /*projection*/) {
  energy_ = &energy;
  reference = energy.points().reference;
  displacement_.assign(at.displacement.begin(), at.displacement.end());
  history_ = at.history;
  damage_ = at.damage;
  environment_ = at.environment;
  energy.outline_rows(at, diagonal, row_sums_);
}

void RowsOfEnergy::multiply(std::span<const double> v, std::span<double> result) const {
  energy_->product(at(), v, result, 0.0);
}

void RowsOfEnergy::for_each_row(const RowVisitor&) const {
  throw std::logic_error("rows of an unsymmetric tangent are no halves of a symmetric one");
}

void RowsOfEnergy::absolute_row_sums(std::span<double> sums) const {
  std::copy(row_sums_.begin(), row_sums_.end(), sums.begin());
}

SparseRows RowsOfEnergy::rows() const { return energy_->rows(at(), RowReach::whole); }

SparseRows RowsOfEnergy::local_rows() const { return energy_->rows(at(), RowReach::local); }

}  // namespace peristat
