#include "src/geometry/lattice_box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/geometry/lattice_frame.hpp"

namespace peristat {
namespace {

using Numbers = std::array<std::int64_t, 3>;

/// Lattice numbers of each point, counted from the lattice's origin.
std::vector<Numbers> numbers_of(const Points& points) {
  const LatticeFrame frame(points.dimension, {}, 0.0, points.spacing, points.angle);
  const Coordinates origin = points.lattice->origin;
  std::vector<Numbers> numbers(std::size_t(points.count()));
  for (Index i = 0; i < points.count(); ++i) {
    Coordinates from_origin = points.position(i);
    for (int c = 0; c < points.dimension; ++c) from_origin[c] -= origin[c];
    const Coordinates spacings = frame.spacings_to(from_origin);
    for (int c = 0; c < points.dimension; ++c) {
      numbers[std::size_t(i)][c] = std::llround(spacings[c]);
    }
  }
  return numbers;
}

}  // namespace

std::optional<LatticeBox> lattice_box(const Points& points, std::string& why_not) {
  if (!points.lattice) {
    why_not = "the points do not lie on a lattice";
    return std::nullopt;
  }
  const std::vector<Numbers> numbers = numbers_of(points);
  LatticeBox box;
  box.dimension = points.dimension;
  Numbers first{};
  double places = 1.0;
  for (int c = 0; c < points.dimension; ++c) {
    const auto [least, most] =
        std::minmax_element(numbers.begin(), numbers.end(),
                            [c](const Numbers& a, const Numbers& b) { return a[c] < b[c]; });
    first[c] = (*least)[c];
    const double extent = double((*most)[c] - first[c]) + 1.0;
    places *= extent;
    if (places > std::numeric_limits<Index>::max()) {
      why_not = "the box around the points has more than 2^31 lattice sites";
      return std::nullopt;
    }
    box.extent[c] = static_cast<Index>(extent);
  }
  std::vector<bool> is_taken(box.count(), false);
  box.place.reserve(numbers.size());
  for (const Numbers& at : numbers) {
    const std::int64_t place =
        ((at[0] - first[0]) * box.extent[1] + (at[1] - first[1])) * box.extent[2] +
        (at[2] - first[2]);
    if (is_taken[std::size_t(place)]) {
      why_not = "several points share a lattice site";
      return std::nullopt;
    }
    is_taken[std::size_t(place)] = true;
    box.place.push_back(static_cast<Index>(place));
  }
  return box;
}

}  // namespace peristat
