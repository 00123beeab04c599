#pragma once

#include <optional>
#include <span>
#include <string>

#include "solvers/ranks/part_of_body.hpp"
#include "src/core/communicator.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// The points of a body that appear in its results: all but images, and in a part of a body those
/// that its rank owns. They come first in the numbering.
class RecordedPoints {
 public:
  /// Both arguments must outlive this object.
  /// @param part null: the body is whole
  RecordedPoints(const Points& points, const PartOfBody* part = nullptr)
      : points_(points), part_(part) {}

  [[nodiscard]] const Points& points() const { return points_; }
  [[nodiscard]] const PartOfBody* part() const { return part_; }
  [[nodiscard]] Index count() const { return part_ ? part_->owned() : points_.own(); }
  [[nodiscard]] int dimension() const { return points_.dimension; }
  /// Communicator of the parts; a sole rank for a whole body.
  [[nodiscard]] const Communicator& ranks() const;

  /// Number of a local point in the results; of an image, that of its source.
  [[nodiscard]] Index number(Index point) const {
    const Index source = points_.source(point);
    return part_ ? static_cast<Index>(part_->number_of(source)) : source;
  }
  /// True if this rank reports a bond. If several ranks have the bond, the owner of its point with
  /// the lower number in the whole body reports it. A bond to an image is reported by the owner of
  /// its other point.
  [[nodiscard]] bool tells(Index lower, Index upper) const {
    if (!part_) return true;
    const bool comes_first = points_.is_image(upper) || number(lower) < number(upper);
    return lower < part_->owned() && comes_first;
  }

  /// The points of a set that are recorded here, ascending.
  [[nodiscard]] std::span<const Index> members(const std::string& set) const;

 private:
  const Points& points_;
  const PartOfBody* part_;
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
