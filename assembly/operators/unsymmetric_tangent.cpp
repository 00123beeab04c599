#include "assembly/operators/unsymmetric_tangent.hpp"

#include <cmath>
#include <stdexcept>

namespace peristat {

void UnsymmetricTangent::for_each_row(const RowVisitor& /*visit*/) const {
  throw std::logic_error("an unsymmetric tangent has no blocks to visit");
}

void UnsymmetricTangent::absolute_row_sums(std::span<double> sums) const {
  const SparseRows matrix = rows();
  for (Index r = 0; r < matrix.rows(); ++r) {
    double sum = 0.0;
    for (Offset k = matrix.offset[std::size_t(r)]; k < matrix.offset[std::size_t(r) + 1]; ++k) {
      sum += std::abs(matrix.value[std::size_t(k)]);
    }
    sums[std::size_t(r)] = sum;
  }
}

}  // namespace peristat
