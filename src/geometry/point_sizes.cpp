#include "src/geometry/point_sizes.hpp"

#include <algorithm>
#include <cmath>

namespace peristat {

double size_of_point(const Points& points, Index point, double cross_section) {
  return std::pow(points.volume[std::size_t(point)] / cross_section, 1.0 / points.dimension);
}

std::vector<double> horizons_of_sizes(const Points& points, double ratio, double cross_section) {
  std::vector<double> horizons;
  horizons.reserve(points.volume.size());
  for (Index i = 0; i < points.count(); ++i) {
    horizons.push_back(ratio * size_of_point(points, i, cross_section));
  }
  return horizons;
}

double largest_horizon(const Points& points) {
  double largest = 0.0;
  for (const double horizon : points.horizons) largest = std::max(largest, horizon);
  return largest;
}

double mean_horizon_ratio(const Points& points, double cross_section) {
  double sum = 0.0;
  for (Index i = 0; i < Index(points.horizons.size()); ++i) {
    sum += points.horizons[std::size_t(i)] / size_of_point(points, i, cross_section);
  }
  return sum / double(points.horizons.size());
}

}  // namespace peristat
