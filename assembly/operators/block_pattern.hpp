#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "src/core/types.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Pairs of points that interact: those of i with points above it are offset[i] .. offset[i+1]-1,
/// by ascending partners. A view.
struct Couplings {
  std::span<const Offset> offset;  ///< points + 1
  PartnersView partner;            ///< partner(i, pair): upper point of a pair of point i

  Couplings(std::span<const Offset> offset_of_rows, const PartnersView& partners)
      : offset(offset_of_rows), partner(partners) {}
  Couplings(const Bonds& bonds) : Couplings(bonds.offset, bonds.partner) {}

  [[nodiscard]] Index points() const { return static_cast<Index>(offset.size()) - 1; }
  [[nodiscard]] PartnersOfPoint of(Index i) const {
    return partner.between(i, offset[i], offset[i + 1]);
  }
  /// The pair of point i with j above it.
  [[nodiscard]] std::optional<Offset> find(Index i, Index j) const {
    const std::optional<Offset> place = of(i).place_of(j);
    if (!place) return std::nullopt;
    return offset[i] + *place;
  }
  [[nodiscard]] bool is_same_view(const Couplings& other) const {
    return offset.data() == other.offset.data() && partner.is_same_view(other.partner);
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

  /// Pattern with rows of its own.
  /// @param upper the partners of i are upper[offset[i]] .. upper[offset[i+1]-1], ascending
  [[nodiscard]] static BlockPattern of_rows(std::vector<Offset> offset,
                                            std::span<const Index> upper);

  /// Pattern of diagonal blocks alone.
  [[nodiscard]] static BlockPattern diagonal(Index points) {
    return of_rows(std::vector<Offset>(std::size_t(points) + 1, 0), {});
  }

  [[nodiscard]] Offset blocks() const { return partner.size(); }

  /// A pattern with the same rows that needs nothing else to outlive it.
  [[nodiscard]] BlockPattern kept() const;
  friend bool operator==(const BlockPattern& one, const BlockPattern& other);

  /// Positions in this pattern of the blocks of one of its terms, in the order of the couplings;
  /// empty: the two orders agree.
  /// @throws std::logic_error if it lacks one
  [[nodiscard]] std::vector<Offset> places_of(const Couplings& couplings) const;

 private:
  struct Rows {
    std::vector<Offset> offset;
    Partners partner;
  };
  explicit BlockPattern(std::shared_ptr<const Rows> rows)
      : Couplings(rows->offset, rows->partner), own_(std::move(rows)) {}

  std::shared_ptr<const Rows> own_;  // null: a view
};

}  // namespace peristat
