#include "assembly/operators/tangent_operator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace peristat {

TangentOperator::TangentOperator(const BlockPattern& of, int dimension_of_points, int threads,
                                 std::vector<RowRange> parts)
    : pattern(of),
      dimension(dimension_of_points),
      ranges(std::move(parts)),
      diagonal(std::size_t(of.points()) * dimension * dimension),
      threads_(threads) {}

void TangentOperator::absolute_row_sums(std::span<double> sums) const {
  multiply_absolute(std::vector<double>(sums.size(), 1.0), sums);
}

void TangentOperator::multiply_absolute(std::span<const double> weight,
                                        std::span<double> result) const {
  const std::size_t d = std::size_t(dimension), entries = d * d;
  std::vector<std::vector<double>> beyond;  // rows beyond each part
  for (const RowRange& range : ranges) beyond.emplace_back(std::size_t(range.rows_beyond()) * d);
  std::fill(result.begin(), result.end(), 0.0);
  for_each_row([&](int part, Index i, std::span<const double> blocks) {
    const RowRange& range = ranges[std::size_t(part)];
    double* const own = &result[std::size_t(i) * d];
    const double* block = &diagonal[std::size_t(i) * entries];
    const double* const own_weight = &weight[std::size_t(i) * d];
    for (std::size_t k = 0; k < entries; ++k) own[k / d] += std::abs(block[k]) * own_weight[k % d];
    block = blocks.data();
    for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond, block += entries) {
      const Index partner = pattern.partner(i, bond);
      double* const other =
          partner < range.last
              ? &result[std::size_t(partner) * d]
              : &beyond[std::size_t(part)][std::size_t(range.place_beyond(partner)) * d];
      const double* const other_weight = &weight[std::size_t(partner) * d];
      for (std::size_t k = 0; k < entries; ++k) {
        own[k / d] += std::abs(block[k]) * other_weight[k % d];
        other[k % d] += std::abs(block[k]) * own_weight[k / d];
      }
    }
  });
  for (std::size_t part = 0; part < ranges.size(); ++part) {
    const double* next = beyond[part].data();
    ranges[part].for_each_beyond([&](Index first, Index last) {
      for (std::size_t k = std::size_t(first) * d; k < std::size_t(last) * d; ++k) {
        result[k] += *next++;
      }
    });
  }
}

}  // namespace peristat
