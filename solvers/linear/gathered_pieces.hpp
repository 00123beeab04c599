#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "src/core/sharing.hpp"

namespace peristat {

/// Pieces of a body that may stand on several ranks, each of which numbers those that it has points
/// of. What the ranks have of a piece is added up at rank 0, which gives back what it makes of it.
/// Of a whole body all of this is as it is given. All ranks make the same calls.
class GatheredPieces {
 public:
  /// Of a whole body.
  explicit GatheredPieces(Index count = 0) : count_(count) {}
  /// @param labels of the pieces here, the same on every rank that has points of a piece
  GatheredPieces(const Communicator& ranks, std::span<const std::int64_t> labels);

  [[nodiscard]] Index count() const { return count_; }  ///< of the whole body
  /// Whether what is gathered is here.
  [[nodiscard]] bool gathers() const { return !ranks_ || ranks_->rank() == 0; }

  /// Sums of values of the pieces over the ranks, where they are gathered; nothing elsewhere.
  /// @param mine width numbers for each piece here
  [[nodiscard]] std::vector<double> sum(std::vector<double> mine, int width) const;
  /// What the pieces here get of values of all.
  /// @param all width numbers for each piece of the body; they count where they are gathered
  [[nodiscard]] std::vector<double> share_out(std::vector<double> all, int width) const;

  /// Pairs of pieces, with some numbers each.
  struct Pairs {
    std::vector<Index> row, column;
    std::vector<double> values;
  };
  /// Visits what every rank has of pairs of pieces, where they are gathered; of several ranks only.
  /// @param pairs of pieces here, with width numbers each
  using VisitPair = std::function<void(Index row, Index column, const double* values)>;
  void for_each_pair(Pairs pairs, int width, const VisitPair& visit) const;

 private:
  const Communicator* ranks_ = nullptr;
  Index count_ = 0;
  std::vector<Index> number_;                 // in the body, of the pieces here
  std::vector<std::vector<Index>> of_ranks_;  // at rank 0, those of every rank
};

/// A number for each point here that all points have which links join, on whichever rank, and no
/// others; a handle, which nothing joins, has one of its own, and what no point here stands for -1.
/// All ranks make the same call.
/// @param joined of each point and handle here, the one that stands for all that links join with it
///        here
[[nodiscard]] std::vector<std::int64_t> labels_over_ranks(const Sharing& sharing, int dimension,
                                                          std::span<const Index> joined);

}  // namespace peristat
