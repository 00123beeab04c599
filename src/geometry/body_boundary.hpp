#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "src/geometry/boundary_faces.hpp"
#include "src/geometry/collared_body.hpp"
#include "src/geometry/solid.hpp"

namespace peristat {

/// The boundary of a body made of shapes: the parts of the shapes' boundaries that have the body on
/// one side and nothing on the other. Covered sides do not belong to it; the sides beside them
/// continue straight over the depth of the cover. Parts of one line, circle, plane, cylinder or
/// sphere are one face; in 2D also parts that meet at less than smooth_angle.
///
/// In 2D faces are found exactly. In 3D they are exact where the perpendicular from the place meets
/// the face. Where other shapes cut the face off there, they are found to about 1e-6 of the body's
/// size, and parts narrower than 1/32 of the distance asked for may be missed. Where surfaces
/// touch, places within about 1e-4 of the size count as cut off; a surface that shapes share is
/// named after the first.
///
/// `near` may be called by many threads if `where` of the covers may.
class BodyBoundary {
 public:
  /// @param shapes must outlive this
  /// @param spacing of the body's points [m]
  /// @throws InputError ("dimension"; "layers") in 1D, or if a side beside a cover is not
  ///         perpendicular to it (2D), so that it can't continue straight
  BodyBoundary(int dimension, const std::vector<ShapeStep>& shapes, std::vector<Cover> covers,
               double spacing);
  ~BodyBoundary();

  /// The nearest place of every face within a distance (closed, to 1e-8 of it), the nearest first.
  /// Among faces whose normals differ by less than smooth_angle only the nearest is kept.
  [[nodiscard]] std::vector<Foot> near(const Coordinates& place, double distance) const;

  /// The same for the faces that the place is below: beyond a concave corner or a gap it is in
  /// front of a face.
  [[nodiscard]] std::vector<Foot> above(const Coordinates& place, double distance) const;

  /// Height along the side's axis of the body's outermost face there, if that is flat [m].
  [[nodiscard]] std::optional<double> outermost(const Side& side) const;

  /// True if a foot is on the body's outermost flat face on a side.
  [[nodiscard]] bool is_on(const Foot& foot, const Side& side) const;

 private:
  Solid solid_;
  CollaredBody body_;
  double nudge_, spacing_;
  std::array<std::optional<double>, 6> outermost_{};  // by 2 axis + (sign > 0)
  std::unique_ptr<BoundaryFaces> faces_;
};

}  // namespace peristat
