#pragma once

#include <optional>
#include <span>
#include <string>

#include "solvers/ranks/part_of_body.hpp"
#include "src/core/communicator.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// The points of a body that its results tell of, the first ones: those that stand for themselves,
/// and of a part of a body those that its rank owns.
class RecordedPoints {
 public:
  /// Both outlive it.
  /// @param part null: the body is whole
  RecordedPoints(const Points& points, const PartOfBody* part = nullptr)
      : points_(points), part_(part) {}

  [[nodiscard]] const Points& points() const { return points_; }
  [[nodiscard]] const PartOfBody* part() const { return part_; }
  [[nodiscard]] Index count() const { return part_ ? part_->owned() : points_.own(); }
  [[nodiscard]] int dimension() const { return points_.dimension; }
  /// Those that have the other parts; a sole one of a whole body.
  [[nodiscard]] const Communicator& ranks() const;

  /// Number in the results of a point that is here; of an image its source's.
  [[nodiscard]] Index number(Index point) const {
    const Index source = points_.source(point);
    return part_ ? static_cast<Index>(part_->number_of(source)) : source;
  }
  /// Whether a bond is told here: one that is here and on another rank, too, is where the point is
  /// owned that has the lower number in the whole body, and one to an image where its other point
  /// is.
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

/// The recorded point that is nearest to a place, of all ranks; of those as near but for round-off
/// the one with the lowest number. A call that all ranks make.
struct NearestRecorded {
  std::optional<Index> here{};  ///< the point, on the rank that has it
  double distance = 0.0;        ///< [m]
};
[[nodiscard]] NearestRecorded nearest_recorded(const RecordedPoints& points,
                                               const Coordinates& place);

/// Without what is not recorded: images and ghosts.
[[nodiscard]] Points only_recorded(const RecordedPoints& points);

}  // namespace peristat
