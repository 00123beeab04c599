#include "assembly/tangent.hpp"

#include <algorithm>
#include <cmath>

namespace peristat {

Tangent::Tangent(const Pattern& of, int dimension_of_points)
    : pattern(of),
      dimension(dimension_of_points),
      diagonal(std::size_t(of.points()) * dimension * dimension),
      off_diagonal(std::size_t(of.blocks()) * dimension * dimension) {}

void Tangent::multiply(std::span<const double> v, std::span<double> result) const {
  const int d = dimension;
  std::fill(result.begin(), result.end(), 0.0);
  for (Index i = 0; i < pattern.points(); ++i) {
    const double* block = &diagonal[std::size_t(i) * d * d];
    for (int r = 0; r < d; ++r) {
      for (int c = 0; c < d; ++c)
        result[std::size_t(i) * d + r] += block[r * d + c] * v[std::size_t(i) * d + c];
    }
    for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
      const Index j = pattern.partner[bond];
      block = &off_diagonal[std::size_t(bond) * d * d];
      for (int r = 0; r < d; ++r) {
        for (int c = 0; c < d; ++c) {
          result[std::size_t(i) * d + r] += block[r * d + c] * v[std::size_t(j) * d + c];
          result[std::size_t(j) * d + c] += block[r * d + c] * v[std::size_t(i) * d + r];
        }
      }
    }
  }
}

void Tangent::absolute_row_sums(std::span<double> sums) const {
  const int d = dimension;
  std::fill(sums.begin(), sums.end(), 0.0);
  for (Index i = 0; i < pattern.points(); ++i) {
    const auto add = [&](Index row, Index column, const double* block) {
      for (int r = 0; r < d; ++r) {
        for (int c = 0; c < d; ++c) {
          const double size = std::abs(block[r * d + c]);
          sums[std::size_t(row) * d + r] += size;
          if (row != column) sums[std::size_t(column) * d + c] += size;
        }
      }
    };
    add(i, i, &diagonal[std::size_t(i) * d * d]);
    for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
      add(i, pattern.partner[bond], &off_diagonal[std::size_t(bond) * d * d]);
    }
  }
}

double Tangent::asymmetry() const {
  const int d = dimension;
  double largest = 0.0, difference = 0.0;
  for (double entry : off_diagonal) largest = std::max(largest, std::abs(entry));
  for (double entry : diagonal) largest = std::max(largest, std::abs(entry));
  for (Index i = 0; i < pattern.points(); ++i) {
    const double* block = &diagonal[std::size_t(i) * d * d];
    for (int r = 0; r < d; ++r) {
      for (int c = 0; c < r; ++c) {
        difference = std::max(difference, std::abs(block[r * d + c] - block[c * d + r]));
      }
    }
  }
  return largest > 0.0 ? difference / largest : 0.0;
}

double Tangent::frobenius_norm() const {
  double sum = 0.0;
  for (double entry : diagonal) sum += entry * entry;
  for (double entry : off_diagonal) sum += 2.0 * entry * entry;
  return std::sqrt(sum);
}

}  // namespace peristat
