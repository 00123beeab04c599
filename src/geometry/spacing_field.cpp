#include "src/geometry/spacing_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "src/geometry/shape_boundary.hpp"

namespace peristat {
namespace {

double spacing_of(const Refinement& region, int dimension, const Coordinates& place) {
  if (contains(region.shape, place)) return region.spacing;
  return region.spacing + region.growth * distance_to_boundary(region.shape, dimension, place);
}

/// Volume of the part of a body's box that lies within a distance of another box.
double volume_within(double distance, const Box& box, const Box& body, int dimension) {
  double volume = 1.0;
  for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
    const double from = std::max(body.min[c], box.min[c] - distance);
    const double to = std::min(body.max[c], box.max[c] + distance);
    volume *= std::max(0.0, to - from);
  }
  return volume;
}

}  // namespace

SpacingField::SpacingField(int dimension, double spacing, const std::vector<Refinement>& regions)
    : dimension_(dimension), spacing_(spacing), regions_(regions) {}

double SpacingField::at(const Coordinates& place) const {
  double least = spacing_;
  for (const Refinement& region : regions_)
    least = std::min(least, spacing_of(region, dimension_, place));
  return least;
}

Coordinates SpacingField::gradient(const Coordinates& place) const {
  const double step = 0.1 * at(place);
  Coordinates slope{};
  for (std::size_t c = 0; c < std::size_t(dimension_); ++c) {
    Coordinates before = place, behind = place;
    before[c] -= step;
    behind[c] += step;
    slope[c] = (at(behind) - at(before)) / (2.0 * step);
  }
  return slope;
}

std::optional<std::size_t> SpacingField::region_at(const Coordinates& place) const {
  const double least = at(place);
  if (least >= spacing_) return std::nullopt;
  for (std::size_t k = 0; k < regions_.size(); ++k) {
    if (spacing_of(regions_[k], dimension_, place) == least) return k;
  }
  return std::nullopt;
}

double SpacingField::finest() const {
  double least = spacing_;
  for (const Refinement& region : regions_) least = std::min(least, region.spacing);
  return least;
}

double SpacingField::most_points(const Box& body) const {
  constexpr int shells = 32;
  double sum = 0.0;
  for (const Refinement& region : regions_) {
    const Box box = bounds(region.shape);
    const double farthest = (spacing_ - region.spacing) / region.growth;
    double volume = volume_within(0.0, box, body, dimension_);
    sum += volume / std::pow(region.spacing, dimension_);
    for (int shell = 0; shell < shells; ++shell) {
      const double from = farthest * shell / shells, to = farthest * (shell + 1) / shells;
      const double larger = volume_within(to, box, body, dimension_);
      sum += (larger - volume) / std::pow(region.spacing + region.growth * from, dimension_);
      volume = larger;
    }
  }
  return sum;
}

}  // namespace peristat
