#include "assembly/tangent.hpp"

#include <algorithm>
#include <cmath>

#include <omp.h>

#include "assembly/assembler.hpp"

namespace peristat {
namespace {

/// result = K v. Each thread adds up its own rows and, apart, what its bonds give to later threads'
/// rows; these are added in the order of the threads.
template <int D>
void multiply_rows(const Tangent& tangent, std::span<const double> v, std::span<double> result) {
  std::vector<std::vector<double>> spilled(tangent.ranges.size());
#pragma omp parallel num_threads(tangent.threads())
  {
    const int thread = omp_get_thread_num();
    const RowRange range = tangent.ranges[thread];
    std::fill(result.begin() + std::ptrdiff_t(range.first) * D,
              result.begin() + std::ptrdiff_t(range.last) * D, 0.0);
    spilled[thread].assign(std::size_t(range.reach - range.last) * D, 0.0);
    double* const beyond = spilled[thread].data();
    for (Index i = range.first; i < range.last; ++i) {
      const double* own = &v[std::size_t(i) * D];
      const double* block = &tangent.diagonal[std::size_t(i) * D * D];
      double sum[D] = {};
      for (int r = 0; r < D; ++r) {
        for (int c = 0; c < D; ++c) sum[r] += block[r * D + c] * own[c];
      }
      block = tangent.off_diagonal.data() + std::size_t(tangent.pattern.offset[i]) * D * D;
      for (Offset bond = tangent.pattern.offset[i]; bond < tangent.pattern.offset[i + 1];
           ++bond, block += D * D) {
        const Index j = tangent.pattern.partner[bond];
        const double* other = &v[std::size_t(j) * D];
        double* to =
            j < range.last ? &result[std::size_t(j) * D] : beyond + std::size_t(j - range.last) * D;
        for (int r = 0; r < D; ++r) {
          for (int c = 0; c < D; ++c) {
            sum[r] += block[r * D + c] * other[c];
            to[c] += block[r * D + c] * own[r];
          }
        }
      }
      for (int r = 0; r < D; ++r) result[std::size_t(i) * D + r] += sum[r];
    }
#pragma omp barrier
    for (int earlier = 0; earlier < thread; ++earlier) {
      const RowRange other = tangent.ranges[earlier];
      const Index first = std::max(range.first, other.last),
                  last = std::min(range.last, other.reach);
      for (std::ptrdiff_t k = std::ptrdiff_t(first) * D; k < std::ptrdiff_t(last) * D; ++k) {
        result[k] += spilled[earlier][k - std::ptrdiff_t(other.last) * D];
      }
    }
  }
}

}  // namespace

Tangent::Tangent(const Pattern& of, int dimension_of_points, int threads)
    : TangentOperator(of, dimension_of_points, threads),
      off_diagonal(std::size_t(of.blocks()) * dimension * dimension) {}

void Tangent::linearise(Assembler& assembler, std::span<const double> displacement,
                        double projection) {
  assembler.tangent(displacement, *this, projection);
}

void Tangent::multiply(std::span<const double> v, std::span<double> result) const {
  if (dimension == 1) multiply_rows<1>(*this, v, result);
  if (dimension == 2) multiply_rows<2>(*this, v, result);
  if (dimension == 3) multiply_rows<3>(*this, v, result);
}

void Tangent::for_each_row(const RowVisitor& visit) const {
  const std::size_t entries = std::size_t(dimension) * dimension;
#pragma omp parallel num_threads(threads())
  {
    const int thread = omp_get_thread_num();
    for (Index i = ranges[thread].first; i < ranges[thread].last; ++i) {
      const std::size_t first = std::size_t(pattern.offset[i]),
                        last = std::size_t(pattern.offset[i + 1]);
      visit(thread, i, std::span(off_diagonal).subspan(first * entries, (last - first) * entries));
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
