#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "src/core/types.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Pairs of points that interact: the partners of i above it are partner[offset[i]] ..
/// partner[offset[i+1]-1], ascending. A view.
struct Couplings {
  std::span<const Offset> offset;  ///< points + 1
  std::span<const Index> partner;

  Couplings(std::span<const Offset> offset_of_rows, std::span<const Index> partners)
      : offset(offset_of_rows), partner(partners) {}
  Couplings(const Bonds& bonds) : Couplings(bonds.offset, bonds.partner) {}

  [[nodiscard]] Index points() const { return static_cast<Index>(offset.size()) - 1; }
  [[nodiscard]] std::span<const Index> of(Index i) const {
    return partner.subspan(std::size_t(offset[i]), std::size_t(offset[i + 1] - offset[i]));
  }
};

/// Sparsity pattern of a tangent: the diagonal blocks, and one block (i, j), i < j, per pair of
/// points that some term couples. Copies share their arrays.
class BlockPattern : public Couplings {
 public:
  /// View of the couplings, which must outlive it.
  explicit BlockPattern(const Couplings& couplings) : Couplings(couplings) {}

  /// Union of the blocks of several terms with the same points; a view if one of the terms has all
  /// of them.
  [[nodiscard]] static BlockPattern united(const std::vector<Couplings>& terms, Index points);

  /// Pattern with rows of its own, laid out as those of Couplings.
  [[nodiscard]] static BlockPattern of_rows(std::vector<Offset> offset, std::vector<Index> partner);

  /// Pattern of diagonal blocks alone.
  [[nodiscard]] static BlockPattern diagonal(Index points) {
    return of_rows(std::vector<Offset>(std::size_t(points) + 1, 0), {});
  }

  [[nodiscard]] Offset blocks() const { return static_cast<Offset>(partner.size()); }

  /// A pattern with the same rows that needs nothing else to outlive it.
  [[nodiscard]] BlockPattern kept() const {
    return own_ ? *this : of_rows({offset.begin(), offset.end()}, {partner.begin(), partner.end()});
  }
  [[nodiscard]] friend bool operator==(const BlockPattern& one, const BlockPattern& other) {
    return std::ranges::equal(one.offset, other.offset) &&
           std::ranges::equal(one.partner, other.partner);
  }

  /// Positions in this pattern of the blocks of one of its terms, in the order of the couplings;
  /// empty: the two orders agree.
  /// @throws std::logic_error if it lacks one
  [[nodiscard]] std::vector<Offset> places_of(const Couplings& couplings) const;

 private:
  struct Rows {
    std::vector<Offset> offset;
    std::vector<Index> partner;
  };
  explicit BlockPattern(std::shared_ptr<const Rows> rows)
      : Couplings(rows->offset, rows->partner), own_(std::move(rows)) {}

  std::shared_ptr<const Rows> own_;  // null: a view
};

/// Rows [first, last) of one thread. Its interactions also touch rows up to `touched_end`,
/// which belong to later threads: what it adds there goes to a buffer of its own and is summed
/// afterwards in the order of the threads, so that a given number of threads always gives the same
/// result.
struct RowRange {
  Index first = 0, last = 0, touched_end = 0;
};

/// Ranges of rows with nearly equal numbers of blocks.
[[nodiscard]] std::vector<RowRange> partition_rows(const BlockPattern& pattern, int threads);

}  // namespace peristat
