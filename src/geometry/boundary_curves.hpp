#pragma once

#include <vector>

#include "src/geometry/boundary_faces.hpp"
#include "src/geometry/collared_body.hpp"

namespace peristat {

/// The boundary of a body in 2D: segments and arcs that have the body on one side.
class BoundaryCurves : public BoundaryFaces {
 public:
  /// @param body of the shapes; must outlive this
  /// @param shapes must outlive this
  /// @param bounds of the body, finite
  /// @param nudge distance from a boundary at which its two sides are tested [m]
  /// @throws InputError, see BodyBoundary
  BoundaryCurves(const CollaredBody& body, const std::vector<ShapeStep>& shapes, const Box& bounds,
                 double nudge);

  void append_feet(const Coordinates& place, double distance,
                   std::vector<Foot>& feet) const override;
  [[nodiscard]] std::optional<double> outermost(const Side& side) const override;

  /// The places start + t along of a segment, or start + radius cos t along + other_radius sin t
  /// across of an arc, for t between `from` and `to`; across is along turned by 90 degrees.
  struct Piece {
    ShapeSide part{};
    double radius = 0.0;          ///< 0: a segment [m]
    double other_radius = 0.0;    ///< of an arc; the same but for ellipses [m]
    Coordinates start{};          ///< of a segment; of an arc its centre [m]
    Coordinates along{};          ///< of length 1
    double from = 0.0, to = 0.0;  ///< [m]; arcs: angles, from < to <= from + 2 pi
    double sign = 1.0;            ///< of the normal out of the body relative to the shape's
    std::size_t face = 0;

    [[nodiscard]] Coordinates at(double t) const;
    /// Way per t.
    [[nodiscard]] double speed(double t) const;
    /// Out of the body.
    [[nodiscard]] Coordinates normal(double t) const;
    /// The t of the nearest place.
    [[nodiscard]] double nearest(const Coordinates& place) const;
  };
  [[nodiscard]] const std::vector<Piece>& pieces() const { return pieces_; }

 private:
  void add_pieces_of(const Piece& whole);
  void append_cuts(const Piece& whole, std::vector<double>& t) const;
  void append_jumps(const Piece& whole, std::vector<double>& t) const;
  void join_faces();
  void check_covers() const;
  [[nodiscard]] double exposure(const Piece& piece, double t) const;
  [[nodiscard]] bool belong_together(const Piece& a, const Piece& b) const;

  const CollaredBody& body_;
  const std::vector<ShapeStep>& shapes_;
  double nudge_;
  std::size_t faces_ = 0;
  std::vector<Piece> pieces_;
};

}  // namespace peristat
