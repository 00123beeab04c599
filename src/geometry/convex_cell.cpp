#include "src/geometry/convex_cell.hpp"

#include <algorithm>
#include <cmath>

#include "src/core/infinity.hpp"
#include "src/geometry/cell_piece.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

/// Intersection of a polygon and a body, as a region.
class PolygonInBody : public Region {
 public:
  /// @param cell, body must outlive this
  PolygonInBody(const ConvexCell& cell, const Solid& body) : cell_(cell), body_(body) {
    for (std::size_t k = 0; k < cell.corners.size(); ++k) {
      const Coordinates& from = cell.corners[k];
      const Coordinates along = minus<3>(cell.corners[(k + 1) % cell.corners.size()], from);
      corners_.push_back(plus<3>(cell.place, from));
      const Coordinates normal{along[1], -along[0], 0.0};
      sides_.push_back({normal, dot<3>(normal, from)});
      // The length of chords kinks where the body's boundary leaves through a side.
      const Line side{corners_.back(), along};
      std::vector<double> t;
      body.append_crossings(side, t);
      for (const double at : t)
        if (at > 0.0 && at < 1.0) kinks_.push_back(side.at(at));
    }
  }

  [[nodiscard]] bool contains(const Coordinates& place) const override {
    const Coordinates arm = minus<3>(place, cell_.place);
    return std::all_of(sides_.begin(), sides_.end(),
                       [&](const Side& side) { return dot<3>(side.normal, arm) <= side.height; }) &&
           body_.contains(place);
  }

  void append_crossings(const Line& line, std::vector<double>& t) const override {
    body_.append_crossings(line, t);
    const Coordinates from = minus<3>(line.from, cell_.place);
    for (const Side& side : sides_) {
      const double along = dot<3>(side.normal, line.along);
      if (along != 0.0) t.push_back((side.height - dot<3>(side.normal, from)) / along);
    }
  }

  void append_levels(const Coordinates& direction, std::vector<double>& levels) const override {
    body_.append_levels(direction, levels);
    for (const Coordinates& corner : corners_) levels.push_back(dot<3>(corner, direction));
    for (const Coordinates& kink : kinks_) levels.push_back(dot<3>(kink, direction));
  }

  bool append_planes(std::array<std::vector<double>, 3>&) const override { return false; }

  [[nodiscard]] bool may_end_near(const Coordinates&, double) const override { return true; }

 private:
  /// normal . (x - place) <= height
  struct Side {
    Coordinates normal;
    double height;
  };

  const ConvexCell& cell_;
  const Solid& body_;
  std::vector<Coordinates> corners_, kinks_;
  std::vector<Side> sides_;
};

/// The rectangle around a polygon, as the only cell of a lattice.
LatticeFrame box_around(const ConvexCell& cell, double& volume) {
  Coordinates low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  for (const Coordinates& arm : cell.corners) {
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], arm[c]);
      high[c] = std::max(high[c], arm[c]);
    }
  }
  const Coordinates middle = plus<3>(cell.place, scaled<3>(0.5, plus<3>(low, high)));
  const Coordinates edges = minus<3>(high, low);
  volume = 1.0;
  for (int c = 0; c < cell.dimension; ++c) volume *= edges[std::size_t(c)];
  return {cell.dimension, middle, 0.0, Spacing(edges, cell.dimension), 0.0};
}

}  // namespace

double ConvexCell::reach() const {
  double farthest = 0.0;
  for (const Coordinates& arm : corners) farthest = std::max(farthest, dot<3>(arm, arm));
  return std::sqrt(farthest);
}

PartInBody part_in_body(const ConvexCell& cell, const Solid& body, Accuracy accuracy) {
  const PartInBody whole{cell.volume, cell.centroid, true};
  const double reach = (1.0 + boundary_tolerance) * cell.reach();
  if (!body.may_end_near(cell.place, reach)) return whole;
  const Solid near = body.near(cell.place, reach);
  std::vector<Coordinates> corners;
  for (const Coordinates& arm : cell.corners) corners.push_back(plus<3>(cell.place, arm));
  if (near.holds_hull_of(corners)) return whole;
  if (cell.dimension == 3) {
    const PolyhedronPart part =
        polyhedron_in_body(cell.place, cell.corners, cell.faces, cell.volume, near, accuracy);
    const Coordinates arm = scaled<3>(1.0 / part.volume, part.moment);
    return {part.volume, plus<3>(cell.place, arm), false};
  }
  double volume = 0.0;
  const LatticeFrame frame = box_around(cell, volume);
  const CellPiece piece = piece_of(frame, {}, PolygonInBody(cell, near));
  return {piece.share * volume, piece.centroid, false};
}

}  // namespace peristat
