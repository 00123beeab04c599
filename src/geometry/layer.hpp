#pragma once

#include <optional>
#include <string>
#include <vector>

#include "src/geometry/side.hpp"
#include "src/geometry/solid.hpp"

namespace peristat {

/// Fictitious points outside the body that carry a support. The layer is also a set; layers of one
/// name make one set, and a place in two layers holds one point that is in both sets.
///
/// On a lattice of whole cells along the body's axes they are copies of the body's outermost
/// lattice plane on one side, shifted outwards by one to `thickness` spacings; on a turned lattice,
/// and where cells are cut, the lattice's points that stand in front of the body's outermost flat
/// face on that side, up to `thickness` spacings away.
struct Layer {
  std::string name{};
  Side side{};
  int thickness = 3;    ///< in spacings
  std::string where{};  ///< optional expression of x, y, z that keeps a part of the layer
};

/// Height [m] of the body's outermost flat face on a side, along the side's axis; none if the
/// outermost part is round. Found from how many feet of the places lie in the body on planes near
/// the face.
/// @param places of points in the body
/// @param spacing of those points [m]
[[nodiscard]] std::optional<double> outermost_face(const Solid& body, const Side& side,
                                                   const std::vector<Coordinates>& places,
                                                   double spacing);

/// Region in front of a flat face of the body: outside it, up to a depth, and not in front of the
/// other faces that come first.
class FrontOfFace : public Region {
 public:
  /// @param body, others must outlive this
  FrontOfFace(const Solid& body, const Side& side, double face, double depth, double spacing,
              std::vector<const FrontOfFace*> others);

  [[nodiscard]] bool contains(const Coordinates& place) const override;
  void append_crossings(const Line& line, std::vector<double>& t) const override;
  void append_levels(const Coordinates& direction, std::vector<double>& levels) const override;
  bool append_planes(std::array<std::vector<double>, 3>& at) const override;
  [[nodiscard]] bool may_end_near(const Coordinates& place, double distance) const override;

  /// Height above the face [m].
  [[nodiscard]] double height(const Coordinates& place) const {
    return side_.sign * (place[side_.axis] - face_);
  }
  [[nodiscard]] Box bounds() const;

 private:
  [[nodiscard]] Coordinates foot(const Coordinates& place) const;

  const Solid& body_;
  Side side_;
  double face_, depth_;
  int dimension_;
  double within_;
  std::vector<const FrontOfFace*> others_;
};

}  // namespace peristat
