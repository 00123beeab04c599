#include "cases/runner/setup/feature_lengths.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <variant>

#include "src/core/coordinates.hpp"
#include "src/core/infinity.hpp"
#include "src/geometry/shape_boundary.hpp"
#include "src/geometry/solid.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

using Kind = FeatureLength::Kind;
using Run = std::array<double, 2>;

/// Intervals of the line's parameter t in which `contains` holds.
template <class Contains>
std::vector<Run> runs(const Line& line, std::vector<double> crossings, const Contains& contains) {
  std::sort(crossings.begin(), crossings.end());
  std::vector<Run> parts;
  for (std::size_t k = 1; k < crossings.size(); ++k) {
    const double begin = crossings[k - 1], end = crossings[k];
    if (!(end - begin > touching_tolerance) || !contains(line.at(0.5 * (begin + end)))) continue;
    if (!parts.empty() && begin - parts.back()[1] <= touching_tolerance) {
      parts.back()[1] = end;
    } else {
      parts.push_back({begin, end});
    }
  }
  return parts;
}

std::vector<Run> runs(const Line& line, const Solid& solid) {
  std::vector<double> crossings;
  solid.append_crossings(line, crossings);
  return runs(line, std::move(crossings),
              [&](const Coordinates& at) { return solid.contains(at); });
}

Box shared(const Box& one, const Box& other) {
  Box both;
  for (std::size_t c = 0; c < 3; ++c) {
    both.min[c] = std::max(one.min[c], other.min[c]);
    both.max[c] = std::min(one.max[c], other.max[c]);
  }
  return both;
}

Coordinates middle(const Box& box, int dimension) {
  Coordinates at{};
  for (std::size_t c = 0; c < std::size_t(dimension); ++c) at[c] = 0.5 * (box.min[c] + box.max[c]);
  return at;
}

/// Smallest width of a polygon across one of its edges.
double width_of_polygon(const Polygon& polygon) {
  double least = infinity;
  const std::size_t count = polygon.vertices.size();
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [ax, ay] = polygon.vertices[k];
    const auto& [bx, by] = polygon.vertices[(k + 1) % count];
    const double edge = std::hypot(bx - ax, by - ay);
    double low = 0.0, high = 0.0;
    for (const auto& [x, y] : polygon.vertices) {
      const double height = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / edge;
      low = std::min(low, height);
      high = std::max(high, height);
    }
    if (edge > 0.0) least = std::min(least, high - low);
  }
  return least;
}

/// Measures openings, and the ligaments that cracks and subtracted shapes leave of a body.
class Measuring {
 public:
  explicit Measuring(const Lattice& lattice)
      : lattice_(lattice), solid_(lattice.dimension, lattice.shapes), body_(solid_.bounds()) {}

  void add_openings() {
    for (std::size_t k = 0; k < lattice_.shapes.size(); ++k) {
      const ShapeStep& step = lattice_.shapes[k];
      if (step.action == ShapeStep::Action::add) continue;
      const std::string key = "lattice.shape[" + std::to_string(k) + "]";
      if (has_smooth_sides(step.shape))
        found_.push_back({Kind::opening, key, width_of(step.shape, lattice_.dimension, body_)});
      const Coordinates at = middle(shared(bounds(step.shape), body_), lattice_.dimension);
      if (solid_.contains(at)) continue;  // filled again
      add_ligaments_along_axes(at, key);
      middles_.emplace_back(at, key);
    }
    constexpr std::size_t most_pairs_of = 50;  // with more holes, only the axes are measured
    if (middles_.size() > most_pairs_of) return;
    for (std::size_t a = 0; a < middles_.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) add_ligaments_between(middles_[b], middles_[a]);
    }
  }

  void add_ahead_of(const Crack& crack, const std::string& key) {
    if (const auto* segment = std::get_if<CrackSegment>(&crack)) {
      add_ahead(segment->from, segment->to, key);
      add_ahead(segment->to, segment->from, key);
    } else if (const auto* polygon = std::get_if<CrackPolygon>(&crack)) {
      Coordinates centre{};
      const double share = 1.0 / double(polygon->vertices.size());
      for (const auto& vertex : polygon->vertices) centre = plus(centre, scaled(share, vertex));
      for (std::size_t k = 0; k < polygon->vertices.size(); ++k) {
        const auto& next = polygon->vertices[(k + 1) % polygon->vertices.size()];
        add_ahead(centre, scaled(0.5, plus(polygon->vertices[k], next)), key);
      }
    }
  }

  [[nodiscard]] std::vector<FeatureLength> found() { return std::move(found_); }

 private:
  using Middle = std::pair<Coordinates, std::string>;

  void add_ligament(double size, const std::string& beside) {
    found_.push_back({Kind::ligament, "ligament beside " + beside, size});
  }

  void add_ligaments_along_axes(const Coordinates& from, const std::string& key) {
    for (std::size_t c = 0; c < std::size_t(lattice_.dimension); ++c) {
      Line line{from, {}};
      const double extent = body_.max[c] - body_.min[c];  // unit of t
      line.along[c] = extent;
      double before = infinity, after = infinity, last = -infinity;
      for (const auto& [begin, end] : runs(line, solid_)) {
        if (end <= 0.0 && end > last) before = end - begin, last = end;
        if (begin >= 0.0 && after == infinity) after = end - begin;
      }
      if (before < infinity) add_ligament(before * extent, key);
      if (after < infinity) add_ligament(after * extent, key);
    }
  }

  void add_ligaments_between(const Middle& one, const Middle& other) {
    const Line line{one.first, minus(other.first, one.first)};
    for (const auto& [begin, end] : runs(line, solid_)) {
      if (begin > 0.0 && end < 1.0) {
        add_ligament((end - begin) * length(line.along), one.second + " and " + other.second);
      }
    }
  }

  /// Adds the ligament beyond `to` if that is a crack tip in the body.
  void add_ahead(const Coordinates& from, const Coordinates& to, const std::string& key) {
    const Line line{from, minus(to, from)};
    for (const auto& [begin, end] : runs(line, solid_)) {
      const bool is_in_body = begin < 1.0 && end > 1.0 + touching_tolerance;
      if (is_in_body) add_ligament((end - 1.0) * length(line.along), key);
    }
  }

  const Lattice& lattice_;
  const Solid solid_;
  const Box body_;
  std::vector<Middle> middles_;
  std::vector<FeatureLength> found_;
};

}  // namespace

double width_of(const Shape& shape, int dimension, const Box& body) {
  double least = infinity;
  const Box box = shared(bounds(shape), body);
  for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
    least = std::min(least, box.max[c] - box.min[c]);
  }
  if (const auto* const ellipse = std::get_if<Ellipse>(&shape))
    return std::min({least, 2.0 * ellipse->radii[0], 2.0 * ellipse->radii[1]});
  const auto* const polygon = std::get_if<Polygon>(&shape);
  return polygon != nullptr ? std::min(least, width_of_polygon(*polygon)) : least;
}

double length_inside(const Shape& shape, int dimension, const Coordinates& from,
                     const Coordinates& to) {
  const Line line{from, minus(to, from)};
  std::vector<double> crossings{0.0, 1.0};
  append_crossings(shape, dimension, line, crossings);
  std::erase_if(crossings, [](double t) { return !(t >= 0.0 && t <= 1.0); });
  double inside = 0.0;
  for (const auto& [begin, end] : runs(line, std::move(crossings), [&](const Coordinates& at) {
         return contains(shape, at);
       })) {
    inside += end - begin;
  }
  return inside * length(line.along);
}

std::vector<FeatureLength> feature_lengths(const Lattice& lattice,
                                           const std::vector<Crack>& cracks) {
  Measuring measuring(lattice);
  measuring.add_openings();
  for (std::size_t k = 0; k < cracks.size(); ++k) {
    measuring.add_ahead_of(cracks[k], "crack[" + std::to_string(k) + "]");
  }
  return measuring.found();
}

}  // namespace peristat
