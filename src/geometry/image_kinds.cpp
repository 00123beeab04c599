#include "src/geometry/image_kinds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// A point nearer to a plane than this share of the spacing stands on it.
constexpr double on_plane = 0.05;

/// Most repetitions of a body that is thinner than its horizon.
constexpr double most_repeats = 100.0;

/// x' = mirror x + shift along one axis.
struct AxisImage {
  double mirror = 1.0, shift = 0.0;
  int periods = 0;
};

std::string axis_name(int axis) { return std::string(1, "xyz"[axis]); }

void require_axis(int axis, int dimension, const std::string& key) {
  if (axis >= 0 && axis < dimension) return;
  throw InputError(key, axis < 0 || axis > 2 ? std::to_string(axis) : '"' + axis_name(axis) + '"',
                   "must be an axis of the body, which has " + std::to_string(dimension));
}

int repeats(double horizon, double length, const std::string& key) {
  const double count = std::ceil(horizon / length) + 1.0;
  if (count <= most_repeats) return static_cast<int>(count);
  throw InputError(key, "",
                   "the body is " + number_text(length) +
                       " m long between its sides, less than a hundredth of the horizon");
}

/// Checks a plane against the points, and returns the side on which they lie (1: above, -1: below).
int side_of(const Points& points, const BodyExtent& body, const SymmetryPlane& plane,
            const std::string& table) {
  const BodyExtent::Along& extent = body.along[std::size_t(plane.axis)];
  const double close = on_plane * points.spacing;
  for (const auto& [at, place] :
       {std::pair(extent.least, extent.first), std::pair(extent.most, extent.last)}) {
    if (std::abs(at - plane.at) > close) continue;
    throw InputError(table + ".at", number_text(plane.at),
                     "the plane passes through points, one of them at " +
                         place_text(place, points.dimension) +
                         " m. It must lie between the points and their images, half a spacing "
                         "before the first points");
  }
  if (extent.least < plane.at && extent.most > plane.at) {
    throw InputError(table + ".at", number_text(plane.at),
                     "points lie on both sides of the plane: between " + number_text(extent.least) +
                         " and " + number_text(extent.most) + " m along " + axis_name(plane.axis) +
                         ". Model only the part on one side");
  }
  return extent.least > plane.at ? 1 : -1;
}

std::vector<AxisImage> mirrored(const Points& points, const BodyExtent& body, int axis,
                                const std::vector<std::pair<std::size_t, SymmetryPlane>>& planes,
                                double horizon) {
  std::vector<AxisImage> images{{}};
  std::optional<double> lower, upper;
  for (const auto& [k, plane] : planes) {
    const std::string table = "symmetries[" + std::to_string(k) + "]";
    std::optional<double>& bound = side_of(points, body, plane, table) > 0 ? lower : upper;
    if (bound) {
      throw InputError(
          table + ".axis", '"' + axis_name(axis) + '"',
          "there is already a plane of symmetry across this axis on the same side of the body");
    }
    bound = plane.at;
  }
  if (lower && upper) {
    const double period = 2.0 * (*upper - *lower);
    const int most = repeats(horizon, period, "symmetries");
    for (int k = -most; k <= most; ++k) {
      if (k != 0) images.push_back({1.0, k * period, 0});
      images.push_back({-1.0, 2.0 * *lower + k * period, 0});
    }
  } else if (lower || upper) {
    images.push_back({-1.0, 2.0 * (lower ? *lower : *upper), 0});
  }
  return images;
}

std::vector<AxisImage> repeated(const Points& points, const BodyExtent& body, const Period& period,
                                const std::string& table, double horizon) {
  const double length = period.to - period.from;
  if (!(length > 0.0)) {
    throw InputError(table + ".to", number_text(period.to), "must be above from");
  }
  const BodyExtent::Along& extent = body.along[std::size_t(period.axis)];
  if (extent.least < period.from || extent.most > period.to ||
      extent.most - extent.least > length - on_plane * points.spacing) {
    throw InputError(
        table + ".to", number_text(period.to),
        "points lie between " + number_text(extent.least) + " and " + number_text(extent.most) +
            " m along " + axis_name(period.axis) +
            ": some are not between from and to, or there are points both at from and at to");
  }
  std::vector<AxisImage> images{{}};
  const int most = repeats(horizon, length, table + ".to");
  for (int k = -most; k <= most; ++k) {
    if (k != 0) images.push_back({1.0, k * length, k});
  }
  return images;
}

std::vector<AxisImage> images_along(const Points& points, const BodyExtent& body, int axis,
                                    const std::vector<SymmetryPlane>& planes,
                                    const std::vector<Period>& periods, double horizon) {
  std::vector<std::pair<std::size_t, SymmetryPlane>> own;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    require_axis(planes[k].axis, points.dimension, "symmetries[" + std::to_string(k) + "].axis");
    if (planes[k].axis == axis) own.emplace_back(k, planes[k]);
  }
  std::vector<AxisImage> images = mirrored(points, body, axis, own, horizon);
  bool is_taken = !own.empty();
  for (std::size_t k = 0; k < periods.size(); ++k) {
    const std::string table = "periods[" + std::to_string(k) + "]";
    require_axis(periods[k].axis, points.dimension, table + ".axis");
    if (periods[k].axis != axis) continue;
    if (is_taken) {
      throw InputError(table + ".axis", '"' + axis_name(axis) + '"',
                       "this axis already has a plane of symmetry or a period");
    }
    is_taken = true;
    images = repeated(points, body, periods[k], table, horizon);
  }
  return images;
}

}  // namespace

BodyExtent extent_of(const Points& points, const Communicator& ranks) {
  constexpr std::size_t width = 8;  // per axis: least and most, each with a place
  std::vector<double> mine;
  for (int axis = 0; axis < points.dimension; ++axis) {
    BodyExtent::Along here;
    for (Index i = 0; i < points.owned.value_or(points.count()); ++i) {
      const double at = points.reference[std::size_t(i) * points.dimension + std::size_t(axis)];
      if (at < here.least) here.least = at, here.first = points.position(i);
      if (at > here.most) here.most = at, here.last = points.position(i);
    }
    mine.push_back(here.least);
    mine.insert(mine.end(), here.first.begin(), here.first.end());
    mine.push_back(here.most);
    mine.insert(mine.end(), here.last.begin(), here.last.end());
  }
  const std::vector<double> all = ranks.all_of(mine);
  BodyExtent body;
  for (std::size_t k = 0; k < all.size(); k += width) {
    BodyExtent::Along& along = body.along[k / width % std::size_t(points.dimension)];
    const auto place = [&](std::size_t at) {
      return Coordinates{all[at], all[at + 1], all[at + 2]};
    };
    if (all[k] < along.least) along.least = all[k], along.first = place(k + 1);
    if (all[k + 4] > along.most) along.most = all[k + 4], along.last = place(k + 5);
  }
  return body;
}

std::vector<ImageKind> image_kinds(const Points& points, const BodyExtent& body,
                                   const std::vector<SymmetryPlane>& planes,
                                   const std::vector<Period>& periods, double reach_of_body) {
  if (planes.empty() && periods.empty()) return {};
  const std::string first = planes.empty() ? "periods[0].axis" : "symmetries[0].axis";
  if (!points.neighbours.empty()) {
    throw InputError(first, "",
                     "given neighbours do not continue beyond a plane of symmetry or a period");
  }
  if (points.angle != 0.0) {
    throw InputError(first, "",
                     "a turned lattice does not continue beyond a plane of symmetry or a period");
  }
  std::vector<ImageKind> kinds{{}};
  for (int axis = 0; axis < points.dimension; ++axis) {
    const std::size_t c = std::size_t(axis);
    std::vector<ImageKind> with_axis;
    for (const AxisImage& along :
         images_along(points, body, axis, planes, periods, reach_of_body)) {
      for (ImageKind kind : kinds) {
        kind.mirror[c] = along.mirror;
        kind.shift[c] = along.shift;
        kind.periods[c] = along.periods;
        with_axis.push_back(kind);
      }
    }
    kinds = std::move(with_axis);
  }
  std::erase_if(kinds, [](const ImageKind& kind) {
    return kind.mirror == ImageKind{}.mirror && kind.shift == Coordinates{};
  });
  return kinds;
}

void require_lattice_goes_on(const Points& lattice, const std::vector<SymmetryPlane>& planes,
                             const std::vector<Period>& periods, const Communicator& ranks) {
  if (planes.empty() && periods.empty()) return;
  const BodyExtent body = extent_of(lattice, ranks);
  constexpr double same = 1e-6;  // of a spacing
  const auto require = [&](const std::string& key, int axis, double found, double wanted) {
    const double spacing = lattice.spacing.along(axis);
    if (std::abs(found - wanted * spacing) <= same * spacing) return;
    throw InputError(key, "",
                     "the lattice does not continue beyond it: the outermost points are " +
                         number_text(found) + " m away along " + axis_name(axis) + " instead of " +
                         number_text(wanted * spacing));
  };
  for (std::size_t k = 0; k < planes.size(); ++k) {
    require_axis(planes[k].axis, lattice.dimension, "symmetries[" + std::to_string(k) + "].axis");
    static_cast<void>(side_of(lattice, body, planes[k], "symmetries[" + std::to_string(k) + "]"));
    const BodyExtent::Along& extent = body.along[std::size_t(planes[k].axis)];
    const double away =
        std::min(std::abs(extent.least - planes[k].at), std::abs(extent.most - planes[k].at));
    require("symmetries[" + std::to_string(k) + "].at", planes[k].axis, away, 0.5);
  }
  for (std::size_t k = 0; k < periods.size(); ++k) {
    require_axis(periods[k].axis, lattice.dimension, "periods[" + std::to_string(k) + "].axis");
    const BodyExtent::Along& extent = body.along[std::size_t(periods[k].axis)];
    const double missing = periods[k].to - periods[k].from - (extent.most - extent.least);
    require("periods[" + std::to_string(k) + "].to", periods[k].axis, missing, 1.0);
  }
}

}  // namespace peristat
