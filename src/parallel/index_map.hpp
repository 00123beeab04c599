#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "src/core/types.hpp"
#include "src/parallel/communicator.hpp"
#include "src/parallel/ghost_exchange.hpp"
#include "src/parallel/numbered_points.hpp"

namespace peristat {

/// Index map: how the points of this rank are numbered in the whole body, and which of them other
/// ranks own. Points are ordered: owned points, ghosts (copies of points that other ranks own),
/// images of both, those of owned points first. Arrays per degree of freedom may end with
/// generalised degrees of freedom of constraints: all ranks have these, and rank 0 owns them.
///
/// A rank computes every interaction of its owned points, so that their rows are complete and only
/// the values of ghosts come from other ranks. A body that one rank holds whole has a map, too.
class IndexMap {
 public:
  /// Map of a body that this rank alone holds: no ghosts, and numbers are those of the points.
  IndexMap(Index own, Index images);

  /// Numbers of a part's points in the whole body, ascending.
  struct Numbers {
    std::vector<GlobalIndex> owned, ghosts;
    std::vector<int> owner;              ///< rank that owns each ghost
    Index images = 0, owned_images = 0;  ///< all here, and those of owned points
    GlobalIndex whole = 0;               ///< points of the whole body
  };
  /// Map of a part of a body. The ranks must outlive it.
  /// @param exchange of `dimension` values per point
  IndexMap(const Communicator& ranks, Numbers numbers, int dimension,
           std::unique_ptr<GhostExchange> exchange);

  /// True if this rank alone holds the body.
  [[nodiscard]] bool is_whole() const { return !exchange_; }
  [[nodiscard]] const Communicator& ranks() const { return ranks_; }
  /// True on the one rank that counts what all ranks have alike.
  [[nodiscard]] bool is_first_rank() const { return ranks_.rank() == 0; }

  [[nodiscard]] Index owned() const { return owned_; }
  [[nodiscard]] bool owns(Index point) const { return point < owned_; }
  /// How many of the first rows of a matrix, or of an array per point, are this rank's alone: those
  /// of owned points, or of a whole body all.
  [[nodiscard]] Index own_rows(Index rows) const {
    return is_whole() ? rows : std::min(owned_, rows);
  }
  /// Number of points on this rank, with ghosts and images.
  [[nodiscard]] Index count() const { return first_image_ + numbers_.images; }
  [[nodiscard]] Index first_image() const { return first_image_; }
  /// Number of images of owned points, which come first among the images.
  [[nodiscard]] Index owned_images() const { return numbers_.owned_images; }
  /// Points of the whole body.
  [[nodiscard]] GlobalIndex whole() const { return numbers_.whole; }

  /// Number in the whole body of a local point, perhaps a ghost; of no image.
  [[nodiscard]] GlobalIndex number_of(Index point) const {
    return is_whole() ? GlobalIndex(point) : numbered().number_of(point);
  }
  /// Local point with this number in the whole body, if it is here.
  [[nodiscard]] std::optional<Index> find(GlobalIndex number) const;
  /// Numbers of a part's points; of none, if the body is whole.
  [[nodiscard]] NumberedPoints numbered() const {
    return {numbers_.owned, numbers_.ghosts, numbers_.owner};
  }

  /// Copies the owners' values to ghosts and generalised degrees of freedom. Collective.
  /// @param values points x dimension, and generalised degrees of freedom where there are any
  void update_ghosts(std::span<double> values) const;
  /// Copies the owners' one value per point to ghosts. Collective.
  void update_ghost_values(std::span<double> values) const;
  /// Numbers in the whole body of the first `points` points here; zero for images.
  [[nodiscard]] std::vector<double> numbers(std::size_t points) const;

  [[nodiscard]] Traffic traffic() const { return exchange_ ? exchange_->traffic() : Traffic{}; }

 private:
  const Communicator& ranks_;
  Numbers numbers_;
  Index owned_, first_image_;
  std::size_t dimension_ = 0;
  std::unique_ptr<GhostExchange> exchange_;
};

/// Map of a whole body of as many points as there may be, without images: for vectors and matrices
/// of a body that is not partitioned.
[[nodiscard]] const IndexMap& whole_body();

}  // namespace peristat
