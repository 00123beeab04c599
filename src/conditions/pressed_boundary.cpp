#include "src/conditions/pressed_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "src/conditions/loaded_facets.hpp"
#include "src/conditions/points_of_set.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/body_cells.hpp"
#include "src/measures/small_algebra.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// Position of a corner in half spacings.
LatticeCell corner_of(const LatticeCell& cell, const std::array<int, 3>& offset, int dimension) {
  LatticeCell corner{};
  for (int c = 0; c < dimension; ++c) corner[c] = 2 * cell[c] + offset[c];
  return corner;
}

/// Corners of a face, seen from outside counter-clockwise, in half spacings from the cell's centre.
std::vector<std::array<int, 3>> corners_of(const Side& side, int dimension) {
  std::array<int, 3> at{};
  at[side.axis] = side.sign;
  if (dimension == 1) return {at};
  const int second = (side.axis + 1) % dimension;
  std::vector<std::array<int, 3>> corners;
  if (dimension == 2) {
    // Along +y on side x+; along -x on side y+.
    const int first = side.axis == 0 ? -side.sign : side.sign;
    for (const int s : {first, -first}) {
      corners.push_back(at);
      corners.back()[second] = s;
    }
    return corners;
  }
  const int third = (side.axis + 2) % dimension;
  constexpr std::array<std::array<int, 2>, 4> round{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  for (const auto& [a, b] : round) {
    corners.push_back(at);
    corners.back()[second] = a;
    corners.back()[third] = b;
  }
  if (side.sign < 0) std::reverse(corners.begin(), corners.end());
  return corners;
}

class Faces {
 public:
  Faces(const Points& points, const BodyCells& cells, PressedBoundary& boundary)
      : points_(points), cells_(cells), boundary_(boundary) {}

  void add(Index point, const Side& side) {
    const LatticeCell cell = cells_.cell(point);
    std::array<Index, 4> face{};
    Coordinates centre{};
    const auto offsets = corners_of(side, points_.dimension);
    if (points_.owned && !moves_owned_points(cell, offsets)) return;
    for (std::size_t k = 0; k < offsets.size(); ++k) {
      face[k] = number_of(corner_of(cell, offsets[k], points_.dimension));
      for (int c = 0; c < points_.dimension; ++c) {
        centre[c] += boundary_.corner[std::size_t(face[k])][c] / double(offsets.size());
      }
    }
    boundary_.face.push_back(face);
    boundary_.sign.push_back(side.sign);
    boundary_.centre.push_back(centre);
  }

 private:
  [[nodiscard]] bool moves_owned_points(const LatticeCell& cell,
                                        const std::vector<std::array<int, 3>>& offsets) const {
    return std::ranges::any_of(offsets, [&](const std::array<int, 3>& offset) {
      return std::ranges::any_of(points_around(corner_of(cell, offset, points_.dimension)),
                                 [&](Index point) { return points_.owns(point); });
    });
  }

  Index number_of(const LatticeCell& corner) {
    const auto [entry, is_new] = numbers_.try_emplace(corner, Index(boundary_.corner.size()));
    if (!is_new) return entry->second;
    Coordinates at{};
    for (int c = 0; c < points_.dimension; ++c) {
      at[c] = points_.lattice->origin[c] + 0.5 * double(corner[c]) * points_.spacing;
    }
    boundary_.corner.push_back(at);
    boundary_.adjacent.push_back(points_around(corner));
    return entry->second;
  }

  /// The body's points in the cells around a corner and in those next to them.
  std::vector<Index> points_around(const LatticeCell& corner) const {
    std::vector<Index> around;
    constexpr std::array<int, 4> offsets{-3, -1, 1, 3};
    const int last = points_.dimension == 1 ? 4 : points_.dimension == 2 ? 16 : 64;
    for (int k = 0; k < last; ++k) {
      LatticeCell cell{};
      for (int c = 0, rest = k; c < points_.dimension; ++c, rest /= 4) {
        cell[c] = (corner[c] + offsets[std::size_t(rest % 4)]) / 2;
      }
      const Index point = cells_.point(cell);
      if (point >= 0) around.push_back(point);
    }
    return around;
  }

  const Points& points_;
  const BodyCells& cells_;
  PressedBoundary& boundary_;
  std::map<LatticeCell, Index> numbers_;
};

}  // namespace

std::vector<double> face_forces(const PressedBoundary& boundary, std::span<const double> pressure,
                                int dimension) {
  std::vector<double> forces;
  for (std::size_t f = 0; f < boundary.face.size(); ++f) {
    const auto place = [&](std::size_t k) {
      return boundary.corner[std::size_t(boundary.face[f][k])];
    };
    Coordinates area{boundary.sign[f], 0.0, 0.0};
    if (dimension == 2) {
      const Coordinates edge = minus<3>(place(1), place(0));
      area = {edge[1], -edge[0], 0.0};
    } else if (dimension == 3) {
      area = scaled<3>(0.5, cross(minus<3>(place(2), place(0)), minus<3>(place(3), place(1))));
    }
    for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
      forces.push_back(-pressure[f] * boundary.cross_section * area[c]);
    }
  }
  return forces;
}

double reach_of_pressures(const Points& points) {
  constexpr double spacings =
      4.0;  // along each axis: 1.5 from a corner to its points, twice, and 1
  return spacings * std::sqrt(double(points.dimension)) * points.spacing.largest();
}

void add_pressed_faces(const Points& points, const LoadSpecification& load, const std::string& key,
                       PressedBoundary& boundary, const Communicator& ranks) {
  if (load.side && load.side->axis >= points.dimension) {
    throw InputError(key + ".side", name(*load.side), "the body has no such side");
  }
  if (load.set.empty() && !load.side) throw InputError(key, "", "needs a side or a set");
  if (points.mesh) {
    add_pressed_facets(points, load, key, boundary);
    return;
  }
  const BodyCells cells(points, ranks);
  if (points.count() > 0) {  // a part may have none
    boundary.cross_section =
        points.volume.front() / std::pow(points.spacing, double(points.dimension));
  }
  Faces faces(points, cells, boundary);
  const std::vector<Index> members = load.set.empty()
                                         ? cells.outermost(*load.side)
                                         : points_of_set(points, load.set, key + ".set");
  const std::size_t before = boundary.face.size();
  for (const Index point : members) {
    if (cells.point(cells.cell(point)) != point) continue;  // a point of a layer
    for (int axis = 0; axis < points.dimension; ++axis) {
      for (const int sign : {-1, 1}) {
        const Side side{axis, sign};
        const bool is_asked_for = !load.side || name(*load.side) == name(side);
        const bool is_open = cells.is_exposed(point, side);
        if (is_asked_for && is_open) faces.add(point, side);
      }
    }
  }
  const auto added = double(boundary.face.size() - before);
  if (ranks.sum(added) == 0.0) {
    throw InputError(key + ".set", '"' + load.set + '"',
                     "has no point on the boundary of the body, so there are no exposed faces for "
                     "a pressure to act on");
  }
}

}  // namespace peristat
