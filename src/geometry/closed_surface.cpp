#include "src/geometry/closed_surface.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <utility>

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>

#include "src/core/coordinates.hpp"
#include "src/core/infinity.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using AabbTree =
    CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Mesh>>>;
using SideOf = CGAL::Side_of_triangle_mesh<Mesh, Kernel, CGAL::Default, AabbTree>;

[[noreturn]] void refuse_surface(const std::string& why) { throw InputError("file", "", why); }

Kernel::Point_3 point_of(const Coordinates& at) { return {at[0], at[1], at[2]}; }

/// Two vertices, in ascending order.
using Edge = std::array<std::size_t, 2>;

void require_closed(const std::vector<Coordinates>& vertices,
                    const std::vector<ClosedSurface::Triangle>& triangles) {
  std::vector<Edge> edges;
  for (const auto& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
      edges.push_back({low, high});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::size_t wrong = 0, of_first = 0;
  Edge first{};
  for (auto from = edges.begin(); from != edges.end();) {
    const auto to =
        std::find_if(from, edges.end(), [&](const Edge& edge) { return edge != *from; });
    if (to - from != 2 && wrong++ == 0) {
      first = *from;
      of_first = std::size_t(to - from);
    }
    from = to;
  }
  if (wrong == 0) return;
  const Coordinates middle = scaled(0.5, plus(vertices[first[0]], vertices[first[1]]));
  refuse_surface("the surface is not closed: " + std::to_string(wrong) +
                 (wrong == 1 ? " edge does" : " edges do") +
                 " not belong to two triangles; one, at " + place_text(middle, 3) +
                 " m, belongs to " + std::to_string(of_first));
}

/// A mesh whose triangles are oriented alike.
Mesh mesh_of(const std::vector<Coordinates>& vertices,
             std::vector<ClosedSurface::Triangle> triangles) {
  namespace processing = CGAL::Polygon_mesh_processing;
  std::vector<Kernel::Point_3> points;
  for (const Coordinates& vertex : vertices) points.push_back(point_of(vertex));
  Mesh mesh;
  processing::orient_polygon_soup(points, triangles);  // splits edges if it can't
  processing::polygon_soup_to_polygon_mesh(points, triangles, mesh);
  if (!CGAL::is_closed(mesh))
    refuse_surface("the surface has one side only: its triangles can't be oriented alike");
  return mesh;
}

void refuse_crossings(const Mesh& mesh) {
  namespace processing = CGAL::Polygon_mesh_processing;
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  processing::self_intersections(mesh, std::back_inserter(pairs));
  if (pairs.empty()) return;
  const auto at = mesh.point(mesh.target(mesh.halfedge(pairs.front().first)));
  refuse_surface("the surface crosses or touches itself, so that its inside is not defined: " +
                 std::to_string(pairs.size()) + " pairs of triangles intersect, one near " +
                 place_text({at.x(), at.y(), at.z()}, 3) + " m");
}

}  // namespace

struct ClosedSurface::Tree {
  Mesh mesh;
  AabbTree triangles;
  std::unique_ptr<SideOf> side;
};

ClosedSurface::ClosedSurface(const std::vector<Coordinates>& vertices,
                             const std::vector<Triangle>& triangles)
    : bounds_{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}},
      tree_(std::make_unique<Tree>()) {
  double magnitude = 0.0, size = 0.0;
  for (const Coordinates& vertex : vertices) {
    for (std::size_t c = 0; c < 3; ++c) {
      bounds_.min[c] = std::min(bounds_.min[c], vertex[c]);
      bounds_.max[c] = std::max(bounds_.max[c], vertex[c]);
      magnitude = std::max(magnitude, std::abs(vertex[c]));
      if (!std::isfinite(vertex[c])) refuse_surface("a vertex is not finite");
    }
  }
  std::vector<Triangle> kept = triangles;  // without those between two vertices
  std::erase_if(kept,
                [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  if (kept.empty()) refuse_surface("the surface has no triangles with an area");
  for (std::size_t c = 0; c < 3; ++c) size = std::max(size, bounds_.max[c] - bounds_.min[c]);
  slack_ = boundary_tolerance * size + 8 * std::numeric_limits<double>::epsilon() * magnitude;
  require_closed(vertices, kept);
  Mesh& mesh = tree_->mesh;
  mesh = mesh_of(vertices, std::move(kept));
  CGAL::Polygon_mesh_processing::remove_degenerate_faces(mesh);
  mesh.collect_garbage();
  if (mesh.number_of_faces() == 0 || !CGAL::is_closed(mesh))
    refuse_surface("the surface has no inside without its triangles that have no area");
  refuse_crossings(mesh);
  AabbTree& tree = tree_->triangles;
  tree.insert(faces(mesh).begin(), faces(mesh).end(), mesh);
  tree.build();
  tree.accelerate_distance_queries();
  tree_->side = std::make_unique<SideOf>(tree);
}

ClosedSurface::~ClosedSurface() = default;

bool ClosedSurface::contains(const Coordinates& place) const {
  for (std::size_t c = 0; c < 3; ++c)
    if (!(place[c] >= bounds_.min[c] - slack_ && place[c] <= bounds_.max[c] + slack_)) return false;
  const CGAL::Bbox_3 around(place[0] - slack_, place[1] - slack_, place[2] - slack_,
                            place[0] + slack_, place[1] + slack_, place[2] + slack_);
  return tree_->triangles.do_intersect(around) ||
         (*tree_->side)(point_of(place)) != CGAL::ON_UNBOUNDED_SIDE;
}

void ClosedSurface::append_crossings(const Line& line, std::vector<double>& t) const {
  const Kernel::Vector_3 along(line.along[0], line.along[1], line.along[2]);
  if (along.squared_length() == 0.0) return;
  const Kernel::Line_3 whole(point_of(line.from), along);
  const auto append = [&](const Kernel::Point_3& at) {
    t.push_back(((at - point_of(line.from)) * along) / along.squared_length());
  };
  using Found = AabbTree::Intersection_and_primitive_id<Kernel::Line_3>::Type;
  std::vector<Found> found;
  tree_->triangles.all_intersections(whole, std::back_inserter(found));
  for (const Found& one : found) {
    if (const auto* const point = boost::get<Kernel::Point_3>(&one.first)) append(*point);
    if (const auto* const part = boost::get<Kernel::Segment_3>(&one.first)) {
      append(part->source());
      append(part->target());
    }
  }
}

double ClosedSurface::distance(const Coordinates& place) const {
  return std::sqrt(tree_->triangles.squared_distance(point_of(place)));
}

std::shared_ptr<const ClosedSurface> read_stl(const std::filesystem::path& file, double scale,
                                              const Coordinates& translate) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<Kernel::Point_3> points;
  std::vector<ClosedSurface::Triangle> triangles;
  if (!stream || !CGAL::IO::read_STL(stream, points, triangles))
    refuse_surface("this is no complete STL file, neither ASCII nor binary");
  if (triangles.empty()) refuse_surface("the file has no triangles");
  std::vector<Coordinates> vertices;
  for (const Kernel::Point_3& point : points)
    vertices.push_back(plus(scaled(scale, {point.x(), point.y(), point.z()}), translate));
  return std::make_shared<const ClosedSurface>(vertices, triangles);
}

}  // namespace peristat
