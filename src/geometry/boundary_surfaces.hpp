#pragma once

#include <array>
#include <optional>
#include <vector>

#include "src/geometry/boundary_faces.hpp"
#include "src/geometry/collared_body.hpp"

namespace peristat {

/// The boundary of a body in 3D: planes, cylinders and spheres where they have the body on one
/// side.
class BoundarySurfaces : public BoundaryFaces {
 public:
  /// @param body of the shapes; must outlive this
  /// @param bounds of the body, finite
  /// @param nudge distance from a boundary at which its two sides are tested [m]
  BoundarySurfaces(const CollaredBody& body, const std::vector<ShapeStep>& shapes,
                   const Box& bounds, double nudge);

  void append_feet(const Coordinates& place, double distance,
                   std::vector<Foot>& feet) const override;
  /// Also none if the outermost part of the shapes has been subtracted.
  [[nodiscard]] std::optional<double> outermost(const Side& side) const override;

  struct Surface {
    enum class Kind { plane, cylinder, sphere } kind = Kind::plane;
    ShapeSide part{};
    Coordinates middle{};  ///< a place on the plane or the axis; the sphere's centre [m]
    Coordinates axis{};    ///< unit vector: normal of the plane out of the shape; the axis
    double radius = 0.0;   ///< [m]
    Box bounds{};          ///< hold every part that may be a boundary
    /// Sign of the normal out of the body relative to that out of the shape: 1 for an added shape.
    double sign = 1.0;

    /// Out of the shape.
    [[nodiscard]] Coordinates normal(const Coordinates& at) const;
    /// Nearest place.
    [[nodiscard]] Coordinates foot(const Coordinates& place) const;
    /// Two directions along the surface at a place of it, at right angles.
    [[nodiscard]] std::array<Coordinates, 2> tangents(const Coordinates& at) const;
    /// Place that a straight way on the unrolled surface reaches from a place of it.
    [[nodiscard]] Coordinates reached(const Coordinates& from, const Coordinates& direction,
                                      double way) const;
  };

 private:
  [[nodiscard]] bool is_exposed(const Surface& surface, const Coordinates& at) const;
  /// Nearest exposed place, if it is within a distance.
  [[nodiscard]] std::optional<Coordinates> nearest(const Surface& surface, const Coordinates& place,
                                                   double distance) const;
  /// First exposed place on a way along the surface, if it is within a distance of a place.
  [[nodiscard]] std::optional<Coordinates> first_exposed(const Surface& surface,
                                                         const Coordinates& place, double distance,
                                                         const Coordinates& direction,
                                                         double most) const;

  const CollaredBody& body_;
  Box bounds_;
  double nudge_;
  std::vector<Surface> surfaces_;  // each once
};

}  // namespace peristat
