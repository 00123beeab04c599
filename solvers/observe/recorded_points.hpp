#pragma once

#include <optional>
#include <span>
#include <string>

#include "src/geometry/points.hpp"
#include "src/parallel/communicator.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// The points of a body that appear in its results: all but images, and in a part of a body those
/// that its rank owns. They come first in the numbering.
class RecordedPoints {
 public:
  /// Both arguments must outlive this object.
  RecordedPoints(const Points& points, const IndexMap& index_map = whole_body())
      : points_(points), index_map_(index_map) {}

  [[nodiscard]] const Points& points() const { return points_; }
  [[nodiscard]] const IndexMap& index_map() const { return index_map_; }
  [[nodiscard]] Index count() const { return index_map_.own_rows(points_.own()); }
  [[nodiscard]] int dimension() const { return points_.dimension; }
  [[nodiscard]] const Communicator& ranks() const { return index_map_.ranks(); }

  /// Number of a local point in the results; of an image, that of its source.
  [[nodiscard]] Index number(Index point) const {
    return static_cast<Index>(index_map_.number_of(points_.source(point)));
  }
  /// True if this rank reports a bond. If several ranks have the bond, the owner of its point with
  /// the lower number in the whole body reports it. A bond to an image is reported by the owner of
  /// its other point.
  [[nodiscard]] bool tells(Index lower, Index upper) const {
    const bool comes_first = points_.is_image(upper) || number(lower) < number(upper);
    return index_map_.owns(lower) && comes_first;
  }

  /// The points of a set that are recorded here, ascending.
  [[nodiscard]] std::span<const Index> members(const std::string& set) const;

 private:
  const Points& points_;
  const IndexMap& index_map_;
};

/// The recorded point nearest to a place among all ranks; of points equally near up to round-off,
/// the one with the lowest number. Collective.
struct NearestRecorded {
  std::optional<Index> here{};  ///< the point, on the rank that has it
  double distance = 0.0;        ///< [m]
};
[[nodiscard]] NearestRecorded nearest_recorded(const RecordedPoints& points,
                                               const Coordinates& place);

/// Copy of the points without images and ghosts.
[[nodiscard]] Points only_recorded(const RecordedPoints& points);

}  // namespace peristat
