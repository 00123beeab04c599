#include "solvers/observe/recorded_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "src/geometry/nearest_point.hpp"

namespace peristat {

std::span<const Index> RecordedPoints::members(const std::string& set) const {
  const std::vector<Index>& members = points_.sets.at(set);
  return {members.begin(), std::lower_bound(members.begin(), members.end(), count())};
}

NearestRecorded nearest_recorded(const RecordedPoints& points, const Coordinates& place) {
  const NearestPoint mine = nearest_point(points.points(), place, points.count());
  NearestRecorded nearest;
  nearest.distance = points.ranks().min(mine.distance);
  const bool is_as_near =
      mine.distance <= nearest.distance + round_off_of_distances(points.points());
  const double number = is_as_near && points.count() > 0 ? double(points.number(mine.point))
                                                         : std::numeric_limits<double>::infinity();
  if (points.ranks().min(number) == number && std::isfinite(number)) nearest.here = mine.point;
  return nearest;
}

Points only_recorded(const RecordedPoints& points) {
  Points kept = without_images(points.points());
  const auto count = std::size_t(points.count());
  kept.reference.resize(count * std::size_t(kept.dimension));
  kept.volume.resize(count);
  for (auto& [name, values] : kept.columns) values.resize(count);
  for (auto& [name, members] : kept.sets) {
    std::erase_if(members, [&](Index point) { return std::size_t(point) >= count; });
  }
  return kept;
}

}  // namespace peristat
