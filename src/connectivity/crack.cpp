#include "src/connectivity/crack.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "src/core/coordinates.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/counts_bond.hpp"
#include "src/geometry/mesh_interior.hpp"
#include "src/geometry/shape_boundary.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

/// The place a + s (b - a).
Coordinates between(const Coordinates& a, const Coordinates& b, double s) {
  return plus(a, scaled(s, minus(b, a)));
}

/// Distance of a place from the segment p-q. Beyond an end it is measured from that end, so that it
/// is exact near the ends of segments of any length.
double distance(const Coordinates& place, const Coordinates& p, const Coordinates& q) {
  const Coordinates along = minus(q, p), from_p = minus(place, p), from_q = minus(place, q);
  if (dot(from_p, along) <= 0.0) return length(from_p);
  if (dot(from_q, along) >= 0.0) return length(from_q);
  return length(cross(from_p, along)) / length(along);
}

/// Distance of the segments a-b and p-q: the least distance of an end of one from the other or, if
/// they are not parallel, that of the lines' nearest places. The latter is measured at a place of
/// a-b, so that round-off of nearly parallel lines only misses a distance that the ends have, too.
double distance(const Coordinates& a, const Coordinates& b, const Coordinates& p,
                const Coordinates& q) {
  const double of_ends =
      std::min({distance(a, p, q), distance(b, p, q), distance(p, a, b), distance(q, a, b)});
  const Coordinates along = minus(q, p), normal = cross(minus(b, a), along);
  const double square = dot(normal, normal);
  if (square == 0.0) return of_ends;
  const double s = dot(cross(minus(p, a), along), normal) / square;
  return std::min(of_ends, distance(between(a, b, std::clamp(s, 0.0, 1.0)), p, q));
}

// ---- polygon ----

const Coordinates& vertex_after(const CrackPolygon& polygon, std::size_t k) {
  return polygon.vertices[k + 1 < polygon.vertices.size() ? k + 1 : 0];
}

/// Normal whose length is the area; the polygon need not be convex.
Coordinates area_vector(const CrackPolygon& polygon) {
  Coordinates sum{};
  for (std::size_t k = 1; k + 1 < polygon.vertices.size(); ++k) {
    sum = plus(sum, cross(minus(polygon.vertices[k], polygon.vertices[0]),
                          minus(polygon.vertices[k + 1], polygon.vertices[0])));
  }
  return scaled(0.5, sum);
}

/// Even-odd rule in the projection along the largest component of the normal; arbitrary on the
/// edges.
bool is_inside(const CrackPolygon& polygon, const Coordinates& normal, const Coordinates& place) {
  int dropped = 0;
  for (int c = 1; c < 3; ++c) {
    if (std::abs(normal[c]) > std::abs(normal[dropped])) dropped = c;
  }
  const int x = (dropped + 1) % 3, y = (dropped + 2) % 3;
  bool odd = false;
  for (std::size_t k = 0; k < polygon.vertices.size(); ++k) {
    const Coordinates &p = polygon.vertices[k], &q = vertex_after(polygon, k);
    if ((p[y] > place[y]) == (q[y] > place[y])) continue;
    if (place[x] < p[x] + (place[y] - p[y]) / (q[y] - p[y]) * (q[x] - p[x])) odd = !odd;
  }
  return odd;
}

/// Smallest distance of edges that have no vertex in common; zero for a polygon that is not simple.
/// An edge that folds back on its neighbour also meets the edge behind that one, except in a
/// triangle, which then has no area.
double smallest_gap(const CrackPolygon& polygon) {
  const std::size_t count = polygon.vertices.size();
  double gap = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t m = k + 2; m < count; ++m) {
      if (k == 0 && m + 1 == count) continue;
      gap = std::min(gap, distance(polygon.vertices[k], vertex_after(polygon, k),
                                   polygon.vertices[m], vertex_after(polygon, m)));
    }
  }
  return gap;
}

// ---- outline ----

/// visit(from, to) for every side.
template <class Visit>
void for_each_side(const CrackOutline& outline, const Visit& visit) {
  for (std::size_t k = 0; k < outline.vertices.size(); ++k) {
    const auto& p = outline.vertices[k];
    const auto& q = outline.vertices[(k + 1) % outline.vertices.size()];
    visit(Coordinates{p[0], p[1], 0.0}, Coordinates{q[0], q[1], 0.0});
  }
}

// ---- cuts ----

bool meets(const CrackSegment& segment, const Coordinates& a, const Coordinates& b, double slack) {
  return distance(a, b, segment.from, segment.to) <= slack;
}

/// A bond is nearest to a polygon at one of its ends, where it crosses the plane, or at an edge.
bool meets(const CrackPolygon& polygon, const Coordinates& a, const Coordinates& b, double slack) {
  const Coordinates area = area_vector(polygon);
  const Coordinates normal = scaled(1.0 / length(area), area);
  const double height_a = dot(minus(a, polygon.vertices[0]), normal);
  const double height_b = dot(minus(b, polygon.vertices[0]), normal);
  if (std::min(height_a, height_b) > slack || std::max(height_a, height_b) < -slack) return false;
  if (std::abs(height_a) <= slack && is_inside(polygon, normal, a)) return true;
  if (std::abs(height_b) <= slack && is_inside(polygon, normal, b)) return true;
  if ((height_a > 0.0) != (height_b > 0.0)) {
    const double s = height_a / (height_a - height_b);
    if (is_inside(polygon, normal, between(a, b, s))) return true;
  }
  for (std::size_t k = 0; k < polygon.vertices.size(); ++k) {
    if (distance(a, b, polygon.vertices[k], vertex_after(polygon, k)) <= slack) return true;
  }
  return false;
}

bool meets(const CrackOutline& outline, const Coordinates& a, const Coordinates& b, double slack) {
  bool meets_any = false;
  for_each_side(outline, [&](const Coordinates& from, const Coordinates& to) {
    meets_any = meets_any || distance(a, b, from, to) <= slack;
  });
  return meets_any;
}

// ---- shape ----

/// True if a part of the bond lies in the shape.
bool meets(const CrackShape& of, const Coordinates& a, const Coordinates& b, double) {
  const auto in_place = [&](Coordinates at) {  // mirrors are their own inverse
    for (std::size_t c = 0; c < 3; ++c) at[c] = of.image.mirror[c] * (at[c] - of.image.shift[c]);
    return at;
  };
  const Coordinates from = in_place(a);
  const Line bond{from, minus(in_place(b), from)};
  std::vector<double> at{0.0, 1.0};
  append_crossings(of.shape, of.dimension, bond, at);
  std::erase_if(at, [](double t) { return !(t >= 0.0 && t <= 1.0); });
  std::sort(at.begin(), at.end());
  for (std::size_t k = 1; k < at.size(); ++k) {
    const bool is_part = at[k] - at[k - 1] > touching_tolerance;
    if (is_part && contains(of.shape, bond.at(0.5 * (at[k - 1] + at[k])))) return true;
  }
  return false;
}

// ---- bounding boxes ----

Box box_around(const Coordinates& a, const Coordinates& b) {
  Box box;
  for (int c = 0; c < 3; ++c) {
    box.min[c] = std::min(a[c], b[c]);
    box.max[c] = std::max(a[c], b[c]);
  }
  return box;
}

Box box_around(const CrackSegment& segment) { return box_around(segment.from, segment.to); }

Box box_around(const CrackPolygon& polygon) {
  Box box{polygon.vertices[0], polygon.vertices[0]};
  for (const Coordinates& vertex : polygon.vertices) {
    for (int c = 0; c < 3; ++c) {
      box.min[c] = std::min(box.min[c], vertex[c]);
      box.max[c] = std::max(box.max[c], vertex[c]);
    }
  }
  return box;
}

Box box_around(const CrackOutline& outline) {
  CrackPolygon corners;
  for (const auto& [x, y] : outline.vertices) corners.vertices.push_back({x, y, 0.0});
  return box_around(corners);
}

Box box_around(const CrackShape& of) {
  const Box own = bounds(of.shape);
  return box_around(of.image.place(own.min), of.image.place(own.max));
}

bool overlap(const Box& one, const Box& other, double slack) {
  for (int c = 0; c < 3; ++c) {
    if (one.max[c] < other.min[c] - slack || one.min[c] > other.max[c] + slack) return false;
  }
  return true;
}

// ---- checks ----

struct Checker {
  int dimension;
  const std::string& table;

  void require(bool allowed, const char* key, const std::string& value,
               const std::string& what) const {
    if (!allowed) throw InputError(table + "." + key, value, what);
  }

  void fits(const char* key, const char* name, int wanted) const {
    require(dimension == wanted, key, "",
            std::string("a crack given as a ") + name + " needs dimension " +
                std::to_string(wanted) + ", but this case has dimension " +
                std::to_string(dimension));
  }

  void finite(const char* key, const Coordinates& place) const {
    for (int c = 0; c < dimension; ++c) {
      require(std::isfinite(place[c]), key, place_text(place, dimension),
              "must have finite components");
    }
  }

  void operator()(const CrackSegment& segment) const {
    fits("to", "segment", 2);
    finite("from", segment.from);
    finite("to", segment.to);
    require(segment.from != segment.to, "to", place_text(segment.to, dimension),
            "must not be the same place as from: a crack needs a length");
  }

  void operator()(const CrackOutline& outline) const {
    fits("outline", "outline", 2);
    require(outline.vertices.size() >= 3, "outline", "", "needs at least three vertices");
    for_each_side(outline, [&](const Coordinates& from, const Coordinates& to) {
      finite("outline", from);
      require(from != to, "outline", place_text(from, 2),
              "no vertex may be given twice in a row (the last is joined to the first)");
    });
  }

  void operator()(const CrackShape& of) const { check_shape(of.shape, dimension, table, table); }

  void operator()(const CrackPolygon& polygon) const {
    fits("vertices", "polygon", 3);
    require(polygon.vertices.size() >= 3, "vertices", "", "a crack needs at least three vertices");
    for (const Coordinates& vertex : polygon.vertices) finite("vertices", vertex);
    const Box box = box_around(polygon);
    const double extent = length(minus(box.max, box.min));
    const Coordinates area = area_vector(polygon);
    require(length(area) > polygon_tolerance * extent * extent, "vertices", "",
            "a crack needs an area: its vertices lie on one line, or its edges cross");
    for (const Coordinates& vertex : polygon.vertices) {
      const double height = dot(minus(vertex, polygon.vertices[0]), area) / length(area);
      require(std::abs(height) <= polygon_tolerance * extent, "vertices", place_text(vertex, 3),
              "all vertices of a crack must lie in one plane, and this one is " +
                  number_text(std::abs(height)) + " m from that of the others");
    }
    require(smallest_gap(polygon) > polygon_tolerance * extent, "vertices", "",
            "the edges of a crack must not cross or touch, and no vertex may be given twice (the "
            "last is joined to the first)");
  }
};

}  // namespace

void check_crack(const Crack& crack, int dimension, const std::string& table) {
  std::visit(Checker{dimension, table}, crack);
}

bool cuts(const Crack& crack, const Coordinates& a, const Coordinates& b) {
  const double slack = touching_tolerance * length(minus(b, a));
  return std::visit([&](const auto& kind) { return meets(kind, a, b, slack); }, crack);
}

namespace {

/// Cracks together with their images beyond planes of symmetry and periodic sides.
std::vector<Crack> with_images(const std::vector<Crack>& cracks, const Images& images) {
  std::vector<Crack> all = cracks;
  for (const ImageKind& kind : images.kinds) {
    for (Crack crack : cracks) {
      if (auto* segment = std::get_if<CrackSegment>(&crack)) {
        segment->from = kind.place(segment->from);
        segment->to = kind.place(segment->to);
      } else if (auto* polygon = std::get_if<CrackPolygon>(&crack)) {
        for (Coordinates& vertex : polygon->vertices) vertex = kind.place(vertex);
      } else if (auto* shape = std::get_if<CrackShape>(&crack)) {
        shape->image = kind;
      } else {
        for (auto& [x, y] : std::get<CrackOutline>(crack).vertices) {
          const Coordinates at = kind.place({x, y, 0.0});
          x = at[0];
          y = at[1];
        }
      }
      all.push_back(std::move(crack));
    }
  }
  return all;
}

/// Same as `cuts`, but faster for bonds that are far away.
bool meets_near(const Crack& crack, const Coordinates& a, const Coordinates& b) {
  const Box around = std::visit([](const auto& kind) { return box_around(kind); }, crack);
  return overlap(box_around(a, b), around, 2.0 * touching_tolerance * length(minus(b, a))) &&
         cuts(crack, a, b);
}

}  // namespace

std::vector<std::int64_t> bonds_met_by_each(const std::vector<Crack>& cracks,
                                            const std::vector<BondEnds>& cut,
                                            const Points& points) {
  std::vector<std::int64_t> met;
  for (const Crack& crack : cracks) {
    const std::vector<Crack> everywhere = with_images({crack}, points.images);
    met.push_back(std::count_if(cut.begin(), cut.end(), [&](const BondEnds& bond) {
      const auto& [i, j] = bond;
      if (!counts_bond(points, i, j)) return false;
      const auto [a, b] = std::minmax({points.position(i), points.position(j)});
      return std::any_of(everywhere.begin(), everywhere.end(),
                         [&](const Crack& one) { return meets_near(one, a, b); });
    }));
  }
  return met;
}

CutBonds cut_bonds(Bonds& bonds, const Points& points, const std::vector<Crack>& of_body) {
  if (of_body.empty() && !points.interior) return {};
  CutBonds removed{std::vector<double>(points.volume.size(), 0.0), {}};
  const std::vector<Crack> cracks = with_images(of_body, points.images);
  std::vector<Box> boxes;
  for (const Crack& crack : cracks) {
    boxes.push_back(std::visit([](const auto& kind) { return box_around(kind); }, crack));
  }
  bonds.remove_if([&](Index i, Offset bond) {
    const Index j = bonds.partner(i, bond);
    // Orders the ends by position, so that ranks, which number points differently, cut alike.
    const auto [a, b] = std::minmax({points.position(i), points.position(j)});
    const Box box = box_around(a, b);
    const double slack = 2.0 * touching_tolerance * bonds.length(bond);  // more than cuts allows
    bool is_cut = points.interior && points.interior->leaves(a, b, points.images.kinds);
    for (std::size_t k = 0; k < cracks.size() && !is_cut; ++k)
      is_cut = overlap(box, boxes[k], slack) && cuts(cracks[k], a, b);
    if (!is_cut) return false;
    removed.weight[i] += bonds.weight(bond);
    removed.weight[j] += bonds.weight(bond);
    removed.ends.push_back({i, j});
    return true;
  });
  return removed;
}

}  // namespace peristat
