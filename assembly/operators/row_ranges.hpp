#pragma once

#include <algorithm>
#include <vector>

#include "assembly/operators/block_pattern.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// Rows [first, last) of one part. Its interactions also touch rows beyond, which belong to later
/// parts: what it adds there goes to a buffer of its own and is summed afterwards in the order of
/// the parts, so that given parts always give the same result. Most of these rows are near; images
/// and ghosts have the highest numbers of all.
struct RowRange {
  Index first = 0, last = 0;
  Index near_end = 0;                    ///< rows last..near_end are touched
  Index far_first = 0, touched_end = 0;  ///< and rows far_first..touched_end

  [[nodiscard]] Index rows_beyond() const { return near_end - last + touched_end - far_first; }
  /// Place of a row among the touched rows beyond.
  [[nodiscard]] Index place_beyond(Index row) const {
    return row < far_first ? row - last : row - far_first + near_end - last;
  }
  /// Calls visit(first, last) for the touched rows beyond, in their order.
  template <class Visit>
  void for_each_beyond(const Visit& visit) const {
    if (last < near_end) visit(last, near_end);
    if (far_first < touched_end) visit(far_first, touched_end);
  }
  /// The same for those that belong to another part.
  template <class Visit>
  void for_each_beyond(const RowRange& of, const Visit& visit) const {
    for_each_beyond([&](Index from, Index to) {
      const Index low = std::max(from, of.first), high = std::min(to, of.last);
      if (low < high) visit(low, high);
    });
  }
};

/// Ranges of rows with nearly equal numbers of blocks.
/// @param own rows before those of images and ghosts
[[nodiscard]] std::vector<RowRange> partition_rows(const BlockPattern& pattern, int parts,
                                                   Index own);

/// Number of parts that sums over the rows go by: as many as leave few rows beyond the parts, 48 at
/// most, for any number of threads up to it, and one per thread where there are more. Rows beyond
/// take some per cent of a pass's time, and 24 or 32 bytes each.
[[nodiscard]] int parts_of_rows(const BlockPattern& pattern, int threads, Index own);

}  // namespace peristat
