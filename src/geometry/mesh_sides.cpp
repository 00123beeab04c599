#include "src/geometry/mesh_sides.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "src/core/coordinates.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/box_grid.hpp"
#include "src/geometry/element_shape.hpp"
#include "src/geometry/simplex.hpp"

namespace peristat {
namespace {

[[noreturn]] void refuse_mesh(const std::string& file, const std::string& what) {
  throw InputError("file", file, what);
}

/// A side of an element, found again by its nodes.
struct ElementSide {
  std::array<Index, 4> sorted{-1, -1, -1, -1};
  Index element = 0;
  int side = 0;
  bool operator<(const ElementSide& other) const {
    return std::tie(sorted, element, side) < std::tie(other.sorted, other.element, other.side);
  }
};

std::vector<Index> nodes_of(const MeshBody& body, const ElementSide& of) {
  const auto element = std::size_t(of.element);
  const std::vector<Index> corners = body.corners_of(element);
  std::vector<Index> nodes;
  for (const int k : shape_of(body.elements.kind[element]).sides[std::size_t(of.side)])
    nodes.push_back(corners[std::size_t(k)]);
  return nodes;
}

std::vector<ElementSide> all_sides(const MeshBody& body) {
  std::vector<ElementSide> sides;
  for (std::size_t e = 0; e < body.count(); ++e) {
    const int count = int(shape_of(body.elements.kind[e]).sides.size());
    for (int k = 0; k < count; ++k) {
      ElementSide side{{-1, -1, -1, -1}, Index(e), k};
      std::vector<Index> nodes = nodes_of(body, side);
      std::sort(nodes.begin(), nodes.end());
      std::copy(nodes.begin(), nodes.end(), side.sorted.begin());
      sides.push_back(side);
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

/// True if two elements see the nodes of a side in the same circular order: they are on one side.
bool see_same_order(const std::vector<Index>& one, const std::vector<Index>& other) {
  const auto at = std::find(other.begin(), other.end(), one[0]);
  const auto k = std::size_t(at - other.begin());
  if (one.size() == 2) return k == 0;
  return other[(k + 1) % other.size()] == one[1];
}

void refuse_overlap(const MeshBody& body, const std::string& file, const ElementSide& a,
                    const ElementSide& b) {
  const auto sorted = [&](Index element) {
    std::vector<Index> corners = body.corners_of(std::size_t(element));
    std::sort(corners.begin(), corners.end());
    return corners;
  };
  const std::string both = element_text(body, std::size_t(a.element)) + " and " +
                           element_text(body, std::size_t(b.element));
  if (sorted(a.element) == sorted(b.element))
    refuse_mesh(file, both + " have the same nodes: the mesh has an element twice");
  if (!see_same_order(nodes_of(body, a), nodes_of(body, b))) return;
  refuse_mesh(file,
              both +
                  " lie on the same side of the side that they share, and so overlap: one "
                  "of them is inverted, or a node is in a wrong place; mesh again, perhaps with "
                  "another algorithm or size");
}

/// Parts of the boundary's facets, with a grid to find them.
class BoundaryParts {
 public:
  explicit BoundaryParts(const MeshBody& body) : body_(body) {
    double size = 0.0;
    for (std::size_t f = 0; f < body.boundary.size(); ++f) {
      const MeshBody::Facet& facet = body.boundary[f];
      for (const FacetPart& part :
           parts_of({facet.corner.begin(), facet.corner.begin() + facet.corners})) {
        parts_.push_back({part, f});
        const std::vector<Coordinates> corners = places(parts_.size() - 1);
        double longest = 0.0;
        for (const Coordinates& corner : corners)
          longest = std::max(longest, length(minus(corner, corners[0])));
        tolerance_.push_back(touching_facets * longest);
        boxes_.push_back(box_with(corners, body.dimension, tolerance_.back()));
        size += longest;
      }
    }
    grid_ = BoxGrid(body.dimension, boxes_, size / double(parts_.size()));
  }

  [[nodiscard]] std::size_t count() const { return parts_.size(); }
  [[nodiscard]] const MeshBody::Facet& facet(std::size_t part) const {
    return body_.boundary[parts_[part].second];
  }
  [[nodiscard]] bool has(std::size_t part, Index node) const {
    const MeshBody::Facet& of = facet(part);
    return std::find(of.corner.begin(), of.corner.begin() + of.corners, node) !=
           of.corner.begin() + of.corners;
  }
  [[nodiscard]] std::vector<Coordinates> places(std::size_t part) const {
    std::vector<Coordinates> corners;
    for (std::size_t k = 0; k < std::size_t(body_.dimension); ++k)
      corners.push_back(body_.node(parts_[part].first.corner[k]));
    return corners;
  }

  void refuse_touching_node(Index node, const std::string& file) const {
    const Coordinates at = body_.node(node);
    const Box here{at, at};
    static_cast<void>(grid_.any_near(here, [&](std::size_t part) {
      if (has(part, node) || !do_overlap(here, boxes_[part], body_.dimension)) return false;
      if (distance_from(at, places(part)) > tolerance_[part]) return false;
      refuse_mesh(file, node_text(body_, node) + " lies on a side of " +
                            element_text(body_, std::size_t(facet(part).element)) +
                            " without being one of its corners: elements must meet at whole "
                            "sides. Hanging nodes are not supported, and a slit needs a width of " +
                            number_text(touching_facets) + " element sizes");
    }));
  }

  void refuse_crossing(std::size_t of, const std::string& file) const {
    const MeshBody::Facet& own = facet(of);
    const std::vector<Coordinates> corners = places(of);
    const Box box = box_with(corners, body_.dimension, 0.0);
    static_cast<void>(grid_.any_near(box, [&](std::size_t part) {
      if (!do_overlap(box, boxes_[part], body_.dimension)) return false;
      for (int k = 0; k < own.corners; ++k)
        if (has(part, own.corner[std::size_t(k)])) return false;
      const std::vector<Coordinates> others = places(part);
      for (std::size_t k = 0; k < corners.size(); ++k) {
        if (!crosses_inside(corners[k], corners[(k + 1) % corners.size()], others)) continue;
        refuse_mesh(file, element_text(body_, std::size_t(own.element)) + " and " +
                              element_text(body_, std::size_t(facet(part).element)) +
                              " overlap: their sides cross");
      }
      return false;
    }));
  }

 private:
  const MeshBody& body_;
  std::vector<std::pair<FacetPart, std::size_t>> parts_;  // and the number of its facet
  std::vector<double> tolerance_;
  std::vector<Box> boxes_;
  BoxGrid grid_;
};

/// Refuses quadrilateral sides of the boundary that triangles cover.
void refuse_divided_sides(const MeshBody& body, const std::string& file) {
  std::vector<std::pair<std::array<Index, 3>, Index>> triangles;
  for (const MeshBody::Facet& facet : body.boundary) {
    if (facet.corners != 3) continue;
    std::array<Index, 3> nodes{facet.corner[0], facet.corner[1], facet.corner[2]};
    std::sort(nodes.begin(), nodes.end());
    triangles.emplace_back(nodes, facet.element);
  }
  std::sort(triangles.begin(), triangles.end());
  for (const MeshBody::Facet& facet : body.boundary) {
    for (std::size_t left_out = 0; facet.corners == 4 && left_out < 4; ++left_out) {
      std::array<Index, 3> nodes{};
      for (std::size_t k = 0; k < 3; ++k) nodes[k] = facet.corner[(left_out + 1 + k) % 4];
      std::sort(nodes.begin(), nodes.end());
      const auto found =
          std::lower_bound(triangles.begin(), triangles.end(), std::pair(nodes, Index(-1)));
      if (found == triangles.end() || found->first != nodes) continue;
      refuse_mesh(file, "a quadrilateral side of " +
                            element_text(body, std::size_t(facet.element)) +
                            " meets a triangular side of " +
                            element_text(body, std::size_t(found->second)) +
                            ": elements must meet at whole sides; put pyramids between them");
    }
  }
}

}  // namespace

std::string element_text(const MeshBody& body, std::size_t element) {
  return "element " + std::to_string(body.file_element[element] + 1) + " of the file (" +
         shape_of(body.elements.kind[element]).name + " at " +
         place_text(body.centroid[element], body.dimension) + ")";
}

std::string node_text(const MeshBody& body, Index node) {
  return "node " + std::to_string(node + 1) + " of the file (at " +
         place_text(body.node(node), body.dimension) + ")";
}

void find_mesh_boundary(MeshBody& body, const std::string& file) {
  const std::vector<ElementSide> sides = all_sides(body);
  for (std::size_t k = 0; k < sides.size();) {
    std::size_t end = k + 1;
    while (end < sides.size() && sides[end].sorted == sides[k].sorted) ++end;
    for (std::size_t other = k + 1; other < end; ++other)
      refuse_overlap(body, file, sides[other - 1], sides[other]);
    if (end - k > 2) {
      refuse_mesh(file, "a side belongs to " + std::to_string(end - k) +
                            " elements, at most two can meet there; one of them is " +
                            element_text(body, std::size_t(sides[k].element)));
    }
    if (end - k == 1) {
      MeshBody::Facet facet;
      facet.element = sides[k].element;
      const std::vector<Index> nodes = nodes_of(body, sides[k]);
      facet.corners = int(nodes.size());
      std::copy(nodes.begin(), nodes.end(), facet.corner.begin());
      body.boundary.push_back(facet);
    }
    k = end;
  }
  refuse_divided_sides(body, file);
  const BoundaryParts parts(body);
  std::vector<char> is_on_boundary(body.node_count(), 0);
  for (const MeshBody::Facet& facet : body.boundary) {
    for (int k = 0; k < facet.corners; ++k)
      is_on_boundary[std::size_t(facet.corner[std::size_t(k)])] = 1;
  }
  for (std::size_t node = 0; node < is_on_boundary.size(); ++node)
    if (is_on_boundary[node]) parts.refuse_touching_node(Index(node), file);
  for (std::size_t part = 0; part < parts.count(); ++part) parts.refuse_crossing(part, file);
}

}  // namespace peristat
