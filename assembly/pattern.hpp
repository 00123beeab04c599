#pragma once

#include <span>
#include <vector>

#include "src/neighbourhood/bonds.hpp"
#include "src/types.hpp"

namespace peristat {

/// Sparsity of every tangent: the diagonal blocks, and one block (i, j), i < j, per bond. A view of
/// the bonds, which outlive it.
struct Pattern {
  std::span<const Offset> offset;
  std::span<const Index> partner;

  explicit Pattern(const Bonds& bonds) : offset(bonds.offset), partner(bonds.partner) {}

  [[nodiscard]] Index points() const { return static_cast<Index>(offset.size()) - 1; }
  [[nodiscard]] Offset blocks() const { return static_cast<Offset>(partner.size()); }
};

/// Rows [first, last) of one thread. Its interactions also touch rows up to `reach`, exclusive,
/// which belong to later threads: what it adds there goes to a buffer of its own and is summed
/// afterwards in the order of the threads, so that a given number of threads always gives the same
/// result.
struct RowRange {
  Index first = 0, last = 0, reach = 0;
};

/// Ranges of rows with nearly equal numbers of bonds.
[[nodiscard]] std::vector<RowRange> partition_rows(const Pattern& pattern, int threads);

}  // namespace peristat
