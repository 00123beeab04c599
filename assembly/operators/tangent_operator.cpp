#include "assembly/operators/tangent_operator.hpp"

#include <algorithm>
#include <cmath>

namespace peristat {

TangentOperator::TangentOperator(const BlockPattern& of, int dimension_of_points, int threads)
    : pattern(of),
      dimension(dimension_of_points),
      ranges(partition_rows(of, threads)),
      diagonal(std::size_t(of.points()) * dimension * dimension) {}

void TangentOperator::absolute_row_sums(std::span<double> sums) const {
  multiply_absolute(std::vector<double>(sums.size(), 1.0), sums);
}

void TangentOperator::multiply_absolute(std::span<const double> weight,
                                        std::span<double> result) const {
  const std::size_t d = std::size_t(dimension), entries = d * d;
  std::vector<std::vector<double>> parts;  // rows first..touched_end of each thread
  for (const RowRange& range : ranges)
    parts.emplace_back(std::size_t(range.touched_end - range.first) * d);
  for_each_row([&](int thread, Index i, std::span<const double> blocks) {
    double* const part = parts[std::size_t(thread)].data();
    const Index first = ranges[std::size_t(thread)].first;
    double* const own = part + std::size_t(i - first) * d;
    const double* block = &diagonal[std::size_t(i) * entries];
    const double* const own_weight = &weight[std::size_t(i) * d];
    for (std::size_t k = 0; k < entries; ++k) own[k / d] += std::abs(block[k]) * own_weight[k % d];
    block = blocks.data();
    for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond, block += entries) {
      const Index partner = pattern.partner(i, bond);
      double* const other = part + std::size_t(partner - first) * d;
      const double* const other_weight = &weight[std::size_t(partner) * d];
      for (std::size_t k = 0; k < entries; ++k) {
        own[k / d] += std::abs(block[k]) * other_weight[k % d];
        other[k % d] += std::abs(block[k]) * own_weight[k / d];
      }
    }
  });
  std::fill(result.begin(), result.end(), 0.0);
  for (std::size_t thread = 0; thread < parts.size(); ++thread) {
    const std::size_t first = std::size_t(ranges[thread].first) * d;
    for (std::size_t k = 0; k < parts[thread].size(); ++k) result[first + k] += parts[thread][k];
  }
}

}  // namespace peristat
