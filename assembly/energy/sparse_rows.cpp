#include "assembly/energy/sparse_rows.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace peristat {
namespace {

std::span<const Index> columns_of(const SparseRows& of, std::size_t row) {
  return std::span(of.column).subspan(std::size_t(of.offset[row]),
                                      std::size_t(of.offset[row + 1] - of.offset[row]));
}

}  // namespace

void SparseRows::add(SparseRows other) {
  if (offset.empty()) return std::swap(*this, other);
  std::vector<Offset> joined = offset;
  for (std::size_t row = 0; row + 1 < offset.size(); ++row) {
    const std::span<const Index> own = columns_of(*this, row), added = columns_of(other, row);
    const auto missing = std::ranges::count_if(
        added, [&](Index wanted) { return !std::ranges::binary_search(own, wanted); });
    joined[row + 1] = joined[row] + Offset(own.size()) + missing;
  }
  column.resize(std::size_t(joined.back()));
  value.resize(std::size_t(joined.back()));
  // In place, from the last entry on: none moves to the place of one that is still to come.
  for (std::size_t row = offset.size() - 1; row-- > 0;) {
    auto mine = std::size_t(offset[row + 1]), theirs = std::size_t(other.offset[row + 1]);
    for (auto to = std::size_t(joined[row + 1]); to-- > std::size_t(joined[row]);) {
      const Index a = mine > std::size_t(offset[row]) ? column[mine - 1] : -1;
      const Index b = theirs > std::size_t(other.offset[row]) ? other.column[theirs - 1] : -1;
      const double of_a = a >= b ? value[--mine] : 0.0;
      column[to] = std::max(a, b);
      value[to] = b >= a ? of_a + other.value[--theirs] : of_a;
    }
  }
  offset = std::move(joined);
}

}  // namespace peristat
