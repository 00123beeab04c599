#include "src/geometry/local_spacing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "src/core/coordinates.hpp"
#include "src/core/infinity.hpp"
#include "src/geometry/box_grid.hpp"

namespace peristat {
namespace {

/// The points of a body as boxes without extent.
BoxGrid grid_of_points(const Points& points, double cell) {
  std::vector<Box> boxes;
  for (Index i = 0; i < points.own(); ++i)
    boxes.push_back({points.position(i), points.position(i)});
  return BoxGrid(points.dimension, boxes, cell);
}

/// Calls visit(point, distance) for all points within a distance of a point, itself included.
template <class Visit>
void for_each_within(const Points& points, const BoxGrid& grid, Index of, double radius,
                     const Visit& visit) {
  const Coordinates at = points.position(of);
  static_cast<void>(grid.any_near(box_with({at}, points.dimension, radius), [&](std::size_t k) {
    const double distance = length(minus(points.position(Index(k)), at));
    if (distance <= radius) visit(Index(k), distance);
    return false;
  }));
}

}  // namespace

std::vector<double> local_spacings(const Points& points, double radius) {
  const BoxGrid grid = grid_of_points(points, radius);
  const double cross_section = points.cross_section();
  std::vector<double> spacings;
  for (Index i = 0; i < points.own(); ++i) {
    double sum = 0.0, count = 0.0;
    for_each_within(points, grid, i, radius, [&](Index j, double) {
      sum += points.volume[std::size_t(j)];
      ++count;
    });
    spacings.push_back(std::pow(sum / count / cross_section, 1.0 / points.dimension));
  }
  return spacings;
}

std::vector<double> nearest_distances(const Points& points) {
  const BoxGrid grid = grid_of_points(points, points.spacing);
  std::vector<double> distances(std::size_t(points.own()), infinity);
  if (points.own() < 2) return distances;
  for (Index i = 0; i < points.own(); ++i) {
    double& least = distances[std::size_t(i)];
    for (double radius = points.spacing; least == infinity; radius *= 2.0) {
      for_each_within(points, grid, i, radius, [&](Index j, double distance) {
        if (j != i) least = std::min(least, distance);
      });
    }
  }
  return distances;
}

}  // namespace peristat
