#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "src/parallel/index_map.hpp"

namespace peristat {

/// Aggregates ("pieces") of a body that may extend over several ranks. Each rank numbers the pieces
/// that it has points of. Rank 0 adds up the contributions of all ranks and sends results back. If
/// the body is not partitioned, values are passed through unchanged. All calls are collective.
class GatheredPieces {
 public:
  /// Pieces of a body that is not partitioned.
  explicit GatheredPieces(Index count = 0) : count_(count) {}
  /// @param labels one per piece of this rank, equal on all ranks that have points of the piece
  GatheredPieces(const Communicator& ranks, std::span<const std::int64_t> labels);

  [[nodiscard]] Index count() const { return count_; }  ///< of the whole body
  /// True if values are gathered on this rank.
  [[nodiscard]] bool gathers() const { return ranks_->rank() == 0; }

  /// Sums values of the pieces over the ranks.
  /// @param mine width numbers for each piece of this rank
  /// @return sums for all pieces where values are gathered, nothing elsewhere
  [[nodiscard]] std::vector<double> sum(std::vector<double> mine, int width) const;
  /// Returns the values of the pieces of this rank.
  /// @param all width numbers for each piece of the body; used only where values are gathered
  [[nodiscard]] std::vector<double> share_out(std::vector<double> all, int width) const;

  /// Pairs of pieces, with some numbers for each pair.
  struct Pairs {
    std::vector<Index> row, column;
    std::vector<double> values;
  };
  /// Visits the pairs of every rank on rank 0, by the pieces' numbers in the body. Only for a
  /// partitioned body.
  /// @param pairs of pieces of this rank, with width numbers each
  using VisitPair = std::function<void(Index row, Index column, const double* values)>;
  void for_each_pair(Pairs pairs, int width, const VisitPair& visit) const;

 private:
  const Communicator* ranks_ = &sole_rank();
  Index count_ = 0;
  std::vector<Index> number_;                 // numbers in the body of the pieces of this rank
  std::vector<std::vector<Index>> of_ranks_;  // at rank 0: `number_` of every rank
};

/// Returns a label for each point and generalised degree of freedom ("handle") of this rank. Points
/// have the same label if and only if links join them, on whichever rank. A handle is joined with
/// nothing and has a label of its own. The label is -1 for an image joined with no owned point or
/// ghost. Collective.
/// @param joined for each point and handle here, the representative of all that links join with it
///        on this rank
[[nodiscard]] std::vector<std::int64_t> labels_over_ranks(const IndexMap& index_map,
                                                          std::span<const Index> joined);

}  // namespace peristat
