#include "assembly/operators/rows_of_blocks.hpp"

#include <utility>
#include <vector>

namespace peristat {

SparseRows rows_of_blocks(const Tangent& tangent) {
  const int d = tangent.dimension;
  std::vector<std::vector<std::pair<Index, double>>> entries(std::size_t(tangent.dofs()));
  const auto append = [&](Index i, Index j, const auto& entry) {
    for (int k = 0; k < d * d; ++k) {
      entries[std::size_t(i * d + k / d)].push_back({j * d + k % d, entry(k / d, k % d)});
    }
  };
  // Columns ascend in every row, because the lower points of a row come before it.
  const BlockPattern& pattern = tangent.pattern;
  for (Index i = 0; i < pattern.points(); ++i) {
    append(i, i, [&](int r, int c) { return tangent.diagonal[std::size_t((i * d + r) * d + c)]; });
    for (Offset k = pattern.offset[i]; k < pattern.offset[i + 1]; ++k) {
      const Index j = pattern.partner(i, k);
      append(i, j, [&](int r, int c) { return tangent.entry(k, r, c); });
      append(j, i, [&](int r, int c) { return tangent.entry(k, c, r); });
    }
  }
  SparseRows rows{{0}, {}, {}};
  for (const auto& row : entries) {
    for (const auto& [column, value] : row) {
      rows.column.push_back(column);
      rows.value.push_back(value);
    }
    rows.offset.push_back(Offset(rows.column.size()));
  }
  return rows;
}

}  // namespace peristat
