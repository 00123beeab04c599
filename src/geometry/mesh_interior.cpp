#include "src/geometry/mesh_interior.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/core/coordinates.hpp"
#include "src/geometry/element_shape.hpp"

namespace peristat {
namespace {

/// Depth, relative to the size of an element, by which a bond may leave it: far above the rounding
/// of coordinates in text, far below an element.
constexpr double depth_outside = 0.5 * touching_facets;

/// Part of a bond that round-off may leave uncovered.
constexpr double uncovered_part = 1e-9;

}  // namespace

MeshInterior::MeshInterior(std::shared_ptr<const MeshBody> of) : mesh_(std::move(of)) {
  const MeshBody& mesh = *mesh_;
  double mean = 0.0;
  first_part_.push_back(0);
  for (std::size_t e = 0; e < mesh.count(); ++e) {
    const std::vector<Index> corners = mesh.corners_of(e);
    for (const std::vector<int>& side : shape_of(mesh.elements.kind[e]).sides) {
      std::vector<Index> nodes;
      for (const int k : side) nodes.push_back(corners[std::size_t(k)]);
      const std::vector<FacetPart> parts = parts_of(nodes);
      element_parts_.insert(element_parts_.end(), parts.begin(), parts.end());
    }
    first_part_.push_back(element_parts_.size());
    const double size = std::pow(mesh.measure[e], 1.0 / mesh.dimension);
    slack_.push_back(depth_outside * size);
    mean += size / double(mesh.count());
    std::vector<Coordinates> at;
    for (const Index node : corners) at.push_back(mesh.node(node));
    element_boxes_.push_back(box_with(at, mesh.dimension, slack_.back()));
  }
  elements_ = BoxGrid(mesh.dimension, element_boxes_, mean);
  for (const MeshBody::Facet& facet : mesh.boundary) {
    const double slack = slack_[std::size_t(facet.element)];
    for (const FacetPart& part :
         parts_of({facet.corner.begin(), facet.corner.begin() + facet.corners})) {
      boundary_parts_.push_back(part);
      boundary_slack_.push_back(slack);
      boundary_boxes_.push_back(box_with(places(part), mesh.dimension, slack));
    }
  }
  boundary_ = BoxGrid(mesh.dimension, boundary_boxes_, mean);
}

double MeshInterior::bytes() const {
  const auto of = [](const auto& values) {
    return double(values.size()) * double(sizeof(values.front()));
  };
  const MeshElements& elements = mesh_->elements;
  return of(elements.nodes) + of(elements.kind) + of(elements.offset) + of(elements.corners) +
         of(mesh_->file_element) + of(mesh_->measure) + of(mesh_->centroid) + of(mesh_->boundary) +
         of(first_part_) + of(element_parts_) + of(slack_) + of(element_boxes_) +
         of(boundary_parts_) + of(boundary_slack_) + of(boundary_boxes_) + elements_.bytes() +
         boundary_.bytes();
}

std::vector<Coordinates> MeshInterior::places(const FacetPart& part) const {
  std::vector<Coordinates> at;
  for (std::size_t k = 0; k < std::size_t(mesh_->dimension); ++k)
    at.push_back(mesh_->node(part.corner[k]));
  return at;
}

/// A bond that leaves through a part of the boundary goes from the inner side of its plane to the
/// outer one.
bool MeshInterior::may_leave(const Coordinates& a, const Coordinates& b) const {
  const int dimension = mesh_->dimension;
  const Box around = box_with({a, b}, dimension, 0.0);
  return boundary_.any_near(around, [&](std::size_t part) {
    if (!do_overlap(around, boundary_boxes_[part], dimension)) return false;
    const std::vector<Coordinates> at = places(boundary_parts_[part]);
    const Coordinates along = minus(at[1], at[0]);
    Coordinates normal{along[1], -along[0], 0.0};
    if (dimension == 3) normal = cross(along, minus(at[2], at[0]));
    const double slack = boundary_slack_[part] * length(normal);
    const double height_a = dot(normal, minus(a, at[0]));
    const double height_b = dot(normal, minus(b, at[0]));
    return std::max(height_a, height_b) > slack && std::min(height_a, height_b) <= slack;
  });
}

void MeshInterior::append_covered(const Coordinates& a, const Coordinates& b,
                                  std::vector<Stretch>& covered) const {
  const MeshBody& mesh = *mesh_;
  const Box around = box_with({a, b}, mesh.dimension, 0.0);
  static_cast<void>(elements_.any_near(around, [&](std::size_t element) {
    if (!do_overlap(around, element_boxes_[element], mesh.dimension)) return false;
    for (std::size_t k = first_part_[element]; k < first_part_[element + 1]; ++k) {
      std::vector<Coordinates> corners = places(element_parts_[k]);
      corners.push_back(mesh.centroid[element]);
      const Stretch within = stretch_in(corners, a, b, slack_[element]);
      if (within.begin <= within.end) covered.push_back(within);
    }
    return false;
  }));
}

bool MeshInterior::leaves(const Coordinates& a, const Coordinates& b,
                          const std::vector<ImageKind>& kinds) const {
  if (kinds.empty() && !may_leave(a, b)) return false;
  std::vector<Stretch> covered;
  append_covered(a, b, covered);
  for (const ImageKind& kind : kinds) {
    const auto in_body = [&](Coordinates at) {  // mirrors are their own inverse
      for (std::size_t c = 0; c < 3; ++c) at[c] = kind.mirror[c] * (at[c] - kind.shift[c]);
      return at;
    };
    append_covered(in_body(a), in_body(b), covered);
  }
  std::sort(covered.begin(), covered.end(),
            [](const Stretch& one, const Stretch& other) { return one.begin < other.begin; });
  double reached = 0.0;
  for (const Stretch& stretch : covered) {
    if (stretch.begin > reached + uncovered_part) return true;
    reached = std::max(reached, stretch.end);
  }
  return reached < 1.0 - uncovered_part;
}

}  // namespace peristat
