#pragma once

#include <memory>
#include <vector>

#include "src/geometry/box_grid.hpp"
#include "src/geometry/image_kinds.hpp"
#include "src/geometry/mesh_body.hpp"
#include "src/geometry/simplex.hpp"

namespace peristat {

/// Inside of a body made of a mesh's elements, closed, to find the bonds that leave it.
///
/// A bond leaves the body if elements do not cover its whole length. An element is divided into
/// triangles (2D) or tetrahedra from its centroid to its sides, each widened by a thousandth of the
/// element's size: so bonds along the boundary stay, and bonds that pass outside by less than that.
/// The test is needed only for bonds that go to the outer side of a facet of the boundary near
/// them.
class MeshInterior {
 public:
  explicit MeshInterior(std::shared_ptr<const MeshBody> mesh);

  /// True if a part of a bond from a to b, whose ends are in the body or in an image of it, is in
  /// neither. Thread-safe.
  /// @param kinds of the body's images
  [[nodiscard]] bool leaves(const Coordinates& a, const Coordinates& b,
                            const std::vector<ImageKind>& kinds) const;

  /// Memory of this and of the mesh.
  [[nodiscard]] double bytes() const;

 private:
  [[nodiscard]] bool may_leave(const Coordinates& a, const Coordinates& b) const;
  /// Appends the stretches of a bond that elements cover.
  void append_covered(const Coordinates& a, const Coordinates& b,
                      std::vector<Stretch>& covered) const;
  [[nodiscard]] std::vector<Coordinates> places(const FacetPart& part) const;

  std::shared_ptr<const MeshBody> mesh_;
  std::vector<std::size_t> first_part_;  // of each element's sides, and the end
  std::vector<FacetPart> element_parts_;
  std::vector<double> slack_;  // per element [m]
  std::vector<Box> element_boxes_;
  BoxGrid elements_;
  std::vector<FacetPart> boundary_parts_;
  std::vector<double> boundary_slack_;
  std::vector<Box> boundary_boxes_;
  BoxGrid boundary_;
};

}  // namespace peristat
