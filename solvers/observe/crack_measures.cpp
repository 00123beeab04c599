#include "solvers/observe/crack_measures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "src/core/input_error.hpp"
#include "src/geometry/lattice_frame.hpp"
#include "src/geometry/point_sizes.hpp"

namespace peristat {
namespace {

using Members = std::span<const Index>;

bool touches(const BondEnds& ends, Members set) {
  const auto [i, j] = ends;
  return std::binary_search(set.begin(), set.end(), i) ||
         std::binary_search(set.begin(), set.end(), j);
}

/// Length of the period across an axis [m]; 0 if there is none.
double period_along(const Points& points, std::size_t axis) {
  for (const ImageKind& kind : points.images.kinds) {
    if (kind.periods[axis] == 1) return kind.shift[axis];
  }
  return 0.0;
}

/// The shortest interval that holds all places, on a line or, with a period, a circle.
std::array<double, 2> interval_of(std::vector<double> places, double period) {
  if (period > 0.0) {
    for (double& place : places) place -= period * std::floor(place / period);
  }
  std::sort(places.begin(), places.end());
  std::array<double, 2> interval{places.front(), places.back()};
  double left_out = period - (interval[1] - interval[0]);
  for (std::size_t k = 1; k < places.size() && period > 0.0; ++k) {
    if (places[k] - places[k - 1] <= left_out) continue;
    left_out = places[k] - places[k - 1];
    interval = {places[k], places[k - 1] + period};
  }
  return interval;
}

/// Largest width of the strips nearest to a place, on a line or, with a period, a circle.
double width_at(double place, const std::vector<double>& middles, const std::vector<double>& widths,
                double period) {
  double nearest = std::numeric_limits<double>::infinity(), width = 0.0;
  for (std::size_t k = 0; k < middles.size(); ++k) {
    double away = std::abs(middles[k] - place);
    if (period > 0.0) away = std::abs(std::remainder(away, period));
    if (away > nearest) continue;
    width = away < nearest ? widths[k] : std::max(width, widths[k]);
    nearest = away;
  }
  return width;
}

/// Begin and end of cracks along an axis [m]; both 0 without a crack.
std::array<double, 2> extent(const Points& points, Members set, int axis, const CrackState& crack) {
  const double spacing = points.angle == 0.0 ? points.spacing.along(axis) : double(points.spacing);
  std::vector<double> middles, widths;
  for (const BondEnds& ends : crack.separated) {
    const auto [i, j] = ends;
    const double a = points.position(i)[std::size_t(axis)],
                 b = points.position(j)[std::size_t(axis)];
    const double width = points.horizons.empty()
                             ? spacing
                             : 0.5 * (size_of_point(points, i, crack.cross_section) +
                                      size_of_point(points, j, crack.cross_section));
    if (std::abs(b - a) > 0.5 * width || !touches(ends, set)) continue;
    middles.push_back(0.5 * (a + b));
    widths.push_back(width);
  }
  middles = crack.of_all(std::move(middles));
  widths = crack.of_all(std::move(widths));
  if (middles.empty()) return {0.0, 0.0};
  const double period = period_along(points, std::size_t(axis));
  const auto [begin, end] = interval_of(middles, period);
  return {begin - 0.5 * width_at(begin, middles, widths, period),
          end + 0.5 * width_at(end, middles, widths, period)};
}

/// Faces between the cells of a lattice. Shifted points belong to the site that they were moved
/// from.
class CellFaces {
 public:
  explicit CellFaces(const Points& points)
      : points_(points),
        frame_(points.dimension, {}, 0.0, points.spacing, points.angle),
        origin_(frame_.spacings_to(origin_of(points))) {}

  /// Area of the face between next neighbours [m2], otherwise 0; half across a period, where it
  /// occurs twice.
  [[nodiscard]] double area(const BondEnds& ends) const {
    const auto [i, j] = ends;
    const Cell from = cell_of(i), to = cell_of(j);
    std::int64_t steps = 0;
    int along = 0;
    for (int c = 0; c < points_.dimension; ++c) {
      const std::int64_t apart = std::abs(to[std::size_t(c)] - from[std::size_t(c)]);
      if (apart != 0) along = c;
      steps += apart;
    }
    if (steps != 1) return 0.0;
    const bool is_over_period =
        points_.is_image(j) && points_.image_kind(j).periods != std::array<int, 3>{};
    const double volume =
        0.5 * (points_.volume[points_.source(i)] + points_.volume[points_.source(j)]);
    return (is_over_period ? 0.5 : 1.0) * volume / points_.spacing.along(along);
  }

 private:
  static const Coordinates& origin_of(const Points& points) {
    if (points.lattice) return points.lattice->origin;
    throw InputError("points.lattice", "",
                     "areas and angles of cracks are for points on a lattice");
  }
  [[nodiscard]] Cell cell_of(Index point) const {
    const Coordinates at = frame_.spacings_to(points_.position(point));
    Cell cell{};
    for (std::size_t c = 0; c < 3; ++c) cell[c] = std::llround(at[c] - origin_[c]);
    return cell;
  }

  const Points& points_;
  LatticeFrame frame_;
  Coordinates origin_;
};

/// Area of the faces of separated bonds from number `first` on [m2]. Faces are summed by size,
/// since a resumed run has its broken bonds in another order.
double area(const Points& points, Members set, std::size_t first, const CrackState& crack) {
  const CellFaces of_cells(points);
  std::vector<double> faces;
  for (const BondEnds& ends : crack.separated.subspan(first)) {
    const double size = touches(ends, set) ? of_cells.area(ends) : 0.0;
    if (size != 0.0) faces.push_back(size);
  }
  faces = crack.of_all(std::move(faces));
  std::sort(faces.begin(), faces.end());
  return std::accumulate(faces.begin(), faces.end(), 0.0);
}

/// Direction of the line of least squares through the middles of separated faces, in 2D [degrees].
double angle(const Points& points, Members set, int axis, const CrackState& crack) {
  struct Face {
    double x, y, area;
    auto operator<=>(const Face&) const = default;
  };
  const CellFaces of_cells(points);
  std::vector<double> mine;
  const auto along = std::size_t(axis), across = std::size_t(1 - axis);
  for (const BondEnds& ends : crack.separated) {
    const double size = touches(ends, set) ? of_cells.area(ends) : 0.0;
    if (size == 0.0) continue;
    const Coordinates a = points.position(ends[0]), b = points.position(ends[1]);
    mine.insert(mine.end(), {0.5 * (a[along] + b[along]), 0.5 * (a[across] + b[across]), size});
  }
  const std::vector<double> all = crack.of_all(std::move(mine));
  std::vector<Face> faces;  // sorted, as in area()
  for (std::size_t k = 0; k < all.size(); k += 3) faces.push_back({all[k], all[k + 1], all[k + 2]});
  std::ranges::sort(faces);
  double area = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (const Face& face : faces) {
    area += face.area;
    x += face.area * face.x;
    y += face.area * face.y;
  }
  for (const Face& face : faces) {
    const double from_x = face.x - x / area, from_y = face.y - y / area;
    xx += face.area * from_x * from_x;
    xy += face.area * from_x * from_y;
    yy += face.area * from_y * from_y;
  }
  constexpr double round = 1e-9;  // faces without a preferred direction
  if (std::hypot(xx - yy, 2.0 * xy) <= round * (xx + yy)) return 0.0;
  return 90.0 / std::numbers::pi * std::atan2(2.0 * xy, xx - yy);
}

}  // namespace

const std::vector<CrackMeasure>& crack_measures() {
  static const std::vector<CrackMeasure> all{
      {"crack_length", "m", true,
       [](const Points& points, Members set, int axis, const CrackState& crack) {
         const auto [begin, end] = extent(points, set, axis, crack);
         return end - begin;
       }},
      {"crack_begin", "m", true,
       [](const Points& points, Members set, int axis, const CrackState& crack) {
         return extent(points, set, axis, crack)[0];
       }},
      {"crack_end", "m", true,
       [](const Points& points, Members set, int axis, const CrackState& crack) {
         return extent(points, set, axis, crack)[1];
       }},
      {"crack_angle", "degree", true, angle},
      {"crack_area", "m2", false,
       [](const Points& points, Members set, int, const CrackState& crack) {
         return area(points, set, 0, crack);
       }},
      {"work_of_fracture", "J/m2", false,
       [](const Points& points, Members set, int, const CrackState& crack) {
         const double grown = grown_area(points, set, crack);
         return grown > 0.0 ? crack.taken_up / grown : 0.0;
       }},
      {"crack_resistance", "J/m2", false,
       [](const Points& points, Members set, int, const CrackState& crack) {
         const double growth = grown_area(points, set, crack) - crack.before.area;
         return growth > 0.0 ? (crack.dissipated - crack.before.dissipated) / growth : 0.0;
       }}};
  return all;
}

double grown_area(const Points& points, Members set, const CrackState& crack) {
  return area(points, set, crack.cut, crack);
}

const CrackMeasure* crack_measure(const std::string& name) {
  const auto found = std::ranges::find(crack_measures(), name, &CrackMeasure::name);
  return found == crack_measures().end() ? nullptr : &*found;
}

}  // namespace peristat
