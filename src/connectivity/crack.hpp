#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "src/core/types.hpp"
#include "src/geometry/points.hpp"
#include "src/geometry/shape.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Straight crack in the x-y plane (2D) [m].
struct CrackSegment {
  Coordinates from{}, to{};
};

/// Plane crack (3D): a simple polygon, convex or not; the last vertex is joined to the first [m].
struct CrackPolygon {
  std::vector<Coordinates> vertices;
};

/// Sides of a closed polygon in the x-y plane (2D), like a boundary that bonds must not cross; the
/// last vertex is joined to the first [m].
struct CrackOutline {
  std::vector<std::array<double, 2>> vertices;
};

/// A part of space that bonds must not cross, a hole or a slit: its inside and its boundary.
struct CrackShape {
  Shape shape{};
  int dimension = 2;
  ImageKind image{};  ///< image of the shape that the crack is; default: the shape itself
};

/// A crack that exists from the start. It is closed: its ends or edges belong to it.
using Crack = std::variant<CrackSegment, CrackPolygon, CrackOutline, CrackShape>;

/// Distance from a crack, relative to the bond's length, up to which a bond touches the crack: far
/// above the round-off of coordinates, far below a spacing.
inline constexpr double touching_tolerance = 1e-9;

/// Distance, relative to the polygon's extent, up to which a vertex lies in the plane of a polygon
/// and up to which its edges touch each other; its square bounds the area from below.
inline constexpr double polygon_tolerance = 1e-9;

/// Refuses a crack that does not fit the dimension (segment and outline: 2; polygon: 3; in 1D there
/// is none), has components that are not finite or is degenerate: a segment or a side of an outline
/// without length, a polygon with fewer than three vertices, without area, out of plane, or with
/// edges that cross or touch.
/// @param table table that holds the crack ("crack[0]"); the errors name its "from", "to",
///        "vertices" or "outline"
/// @throws InputError
void check_crack(const Crack& crack, int dimension, const std::string& table);

/// True if the bond from a to b, its ends included, meets the crack:
///
///   min |x - y| <= touching_tolerance |b - a|   over x on the bond and y on the crack
///
/// Touching is enough, and so a point on the crack loses all its bonds. The crack must have passed
/// check_crack.
[[nodiscard]] bool cuts(const Crack& crack, const Coordinates& a, const Coordinates& b);

/// Bonds that cracks have cut.
struct CutBonds {
  std::vector<double> weight;  ///< per point, sum over its cut bonds [m6]; empty: nothing can cut
  std::vector<BondEnds> ends;  ///< end points of each cut bond
};

/// Number of bonds that each crack or its images meet, among those that some crack has cut. For a
/// part of a body: those that it counts.
[[nodiscard]] std::vector<std::int64_t> bonds_met_by_each(const std::vector<Crack>& cracks,
                                                          const std::vector<BondEnds>& cut,
                                                          const Points& points);

/// Removes the bonds that any of the cracks cuts or that leave the mesh of the points; the others
/// keep their order, length and weight.
[[nodiscard]] CutBonds cut_bonds(Bonds& bonds, const Points& points,
                                 const std::vector<Crack>& cracks);

}  // namespace peristat
