#include "src/conditions/loaded_facets.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "src/conditions/points_of_set.hpp"
#include "src/core/coordinates.hpp"
#include "src/core/infinity.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/mesh_body.hpp"
#include "src/geometry/mesh_points.hpp"

namespace peristat {
namespace {

/// Least cosine of the angle between a facet's normal and the side that it faces.
constexpr double facing_a_side = 0.99;

/// Points that a corner moves with: of more than the first number, as many hundreds as there may be
/// around a corner of tetrahedra, the nearest ones.
constexpr std::size_t most_around = 64, least_around = 24;

/// Part of the body's extent within which facets lie on its outermost plane.
constexpr double outermost_plane = 1e-6;

/// Outward normal, as long as the facet's length (2D) or area.
Coordinates area_vector(const MeshBody& mesh, const MeshBody::Facet& facet) {
  const Coordinates along = minus(mesh.node(facet.corner[1]), mesh.node(facet.corner[0]));
  if (facet.corners == 2) return {along[1], -along[0], 0.0};
  const Index last = facet.corner[facet.corners == 3 ? 2 : 3];
  return scaled(0.5, cross(minus(mesh.node(facet.corner[2]), mesh.node(facet.corner[0])),
                           minus(mesh.node(last), mesh.node(facet.corner[1]))));
}

/// The points of a mesh by its elements and nodes.
class PointsOfMesh {
 public:
  explicit PointsOfMesh(const Points& points)
      : at_(points), mesh_(*points.mesh), are_elements_(!points.elements.empty()) {
    std::map<std::int32_t, Index> by_row;
    for (Index i = 0; i < points.own(); ++i) by_row[points.source_row[std::size_t(i)]] = i;
    elements_of_.resize(mesh_.node_count());
    for (std::size_t e = 0; e < mesh_.count(); ++e) {
      for (const Index node : mesh_.corners_of(e))
        elements_of_[std::size_t(node)].push_back(Index(e));
      if (are_elements_) of_element_.push_back(by_row.at(mesh_.file_element[e]));
    }
    of_node_.assign(mesh_.node_count(), -1);
    if (!are_elements_)
      for (const auto& [node, point] : by_row) of_node_[std::size_t(node)] = point;
  }

  /// True if the points of a facet are among the members (true per point).
  [[nodiscard]] bool has_all(const MeshBody::Facet& facet, const std::vector<char>& members) const {
    if (are_elements_) return members[std::size_t(of_element_[std::size_t(facet.element)])] != 0;
    return std::all_of(facet.corner.begin(), facet.corner.begin() + facet.corners, [&](Index node) {
      return members[std::size_t(of_node_[std::size_t(node)])] != 0;
    });
  }

  /// Points that a force on a facet acts on.
  [[nodiscard]] std::vector<Index> behind(const MeshBody::Facet& facet) const {
    if (are_elements_) return {of_element_[std::size_t(facet.element)]};
    std::vector<Index> points;
    for (int k = 0; k < facet.corners; ++k)
      points.push_back(of_node_[std::size_t(facet.corner[std::size_t(k)])]);
    return points;
  }

  /// Points that a corner moves with.
  [[nodiscard]] std::vector<Index> around(Index corner) const {
    std::vector<Index> points;
    for (const Index element : elements_of_[std::size_t(corner)]) {
      for (const Index node : mesh_.corners_of(std::size_t(element))) {
        if (!are_elements_) points.push_back(of_node_[std::size_t(node)]);
        for (const Index next : elements_of_[std::size_t(node)])
          if (are_elements_) points.push_back(of_element_[std::size_t(next)]);
      }
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() > most_around) keep_nearest(points, mesh_.node(corner));
    return points;
  }

 private:
  /// Keeps the nearest points, and those as far away as the last of them.
  void keep_nearest(std::vector<Index>& points, const Coordinates& place) const {
    constexpr double round_off = 1e-9;
    std::vector<double> distances;
    for (const Index point : points) distances.push_back(length(minus(at_.position(point), place)));
    std::vector<double> sorted = distances;
    std::sort(sorted.begin(), sorted.end());
    const double farthest = sorted[least_around - 1] * (1.0 + round_off);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < points.size(); ++k)
      if (distances[k] <= farthest) points[kept++] = points[k];
    points.resize(kept);
  }

  const Points& at_;
  const MeshBody& mesh_;
  bool are_elements_;
  std::vector<std::vector<Index>> elements_of_;  // by node
  std::vector<Index> of_element_, of_node_;
};

/// Numbers of the facets that face a side; without a set those on the outermost plane.
std::vector<std::size_t> facing(const MeshBody& mesh, std::vector<std::size_t> facets,
                                const Side& side, bool is_outermost) {
  const auto axis = std::size_t(side.axis);
  double least = infinity, most = -infinity;
  const auto height = [&](Index node) { return side.sign * mesh.node(node)[axis]; };
  for (const MeshBody::Facet& facet : mesh.boundary) {
    for (int k = 0; k < facet.corners; ++k) {
      most = std::max(most, height(facet.corner[std::size_t(k)]));
      least = std::min(least, height(facet.corner[std::size_t(k)]));
    }
  }
  std::erase_if(facets, [&](std::size_t f) {
    const MeshBody::Facet& facet = mesh.boundary[f];
    if (side.sign * unit(area_vector(mesh, facet))[axis] < facing_a_side) return true;
    return is_outermost &&
           std::any_of(facet.corner.begin(), facet.corner.begin() + facet.corners, [&](Index node) {
             return height(node) < most - outermost_plane * (most - least);
           });
  });
  return facets;
}

/// The facets of a load's set, or all.
std::vector<std::size_t> facets_of_set(const Points& points, const PointsOfMesh& of,
                                       const LoadSpecification& load, const std::string& key) {
  const MeshBody& mesh = *points.mesh;
  std::vector<std::size_t> facets = facets_of(mesh, load.set);
  if (!facets.empty()) return facets;
  facets.resize(mesh.boundary.size());
  std::iota(facets.begin(), facets.end(), std::size_t(0));
  if (load.set.empty()) return facets;
  std::vector<char> members(points.volume.size(), 0);
  for (const Index point : points_of_set(points, load.set, key + ".set"))
    members[std::size_t(point)] = 1;
  std::erase_if(facets, [&](std::size_t f) { return !of.has_all(mesh.boundary[f], members); });
  return facets;
}

std::vector<std::size_t> loaded_facets(const Points& points, const PointsOfMesh& of,
                                       const LoadSpecification& load, const std::string& key) {
  if (load.side && load.side->axis >= points.dimension)
    throw InputError(key + ".side", name(*load.side), "the body has no such side");
  const MeshBody& mesh = *points.mesh;
  std::vector<std::size_t> facets = facets_of_set(points, of, load, key);
  if (load.side) facets = facing(mesh, std::move(facets), *load.side, load.set.empty());
  if (facets.empty()) {
    throw InputError(key + (load.set.empty() ? ".side" : ".set"),
                     load.set.empty() ? name(*load.side) : '"' + load.set + '"',
                     "has no facet of the mesh's boundary for this load to act on");
  }
  return facets;
}

double thickness_of(const Points& points) {
  const MeshBody& mesh = *points.mesh;
  if (mesh.dimension == 3) return 1.0;
  double area = 0.0, volume = 0.0;
  for (const double measure : mesh.measure) area += measure;
  for (Index i = 0; i < points.own(); ++i) volume += points.volume[std::size_t(i)];
  return volume / area;
}

}  // namespace

TractionAreas facet_areas(const Points& points, const LoadSpecification& load,
                          const std::string& key) {
  if (load.depth != Depth::row)
    throw InputError(key + ".depth", "",
                     "is \"row\" for a mesh: a traction acts on the points "
                     "behind the facets");
  const MeshBody& mesh = *points.mesh;
  const PointsOfMesh of(points);
  const double thickness = thickness_of(points);
  std::map<Index, double> areas;
  for (const std::size_t f : loaded_facets(points, of, load, key)) {
    const std::vector<Index> behind = of.behind(mesh.boundary[f]);
    const double area = thickness * length(area_vector(mesh, mesh.boundary[f]));
    for (const Index point : behind) areas[point] += area / double(behind.size());
  }
  TractionAreas all;
  for (const auto& [point, area] : areas) {
    all.points.push_back(point);
    all.area.push_back(area);
  }
  return all;
}

void add_pressed_facets(const Points& points, const LoadSpecification& load, const std::string& key,
                        PressedBoundary& boundary) {
  const MeshBody& mesh = *points.mesh;
  const PointsOfMesh of(points);
  const std::vector<std::size_t> facets = loaded_facets(points, of, load, key);
  boundary.cross_section = thickness_of(points);
  std::map<Index, Index> numbers;  // of nodes among the corners
  for (const std::size_t f : facets) {
    const MeshBody::Facet& facet = mesh.boundary[f];
    std::array<Index, 4> face{};
    Coordinates centre{};
    for (int k = 0; k < facet.corners; ++k) {
      const Index node = facet.corner[std::size_t(k)];
      const auto [entry, is_new] = numbers.try_emplace(node, Index(boundary.corner.size()));
      if (is_new) {
        boundary.corner.push_back(mesh.node(node));
        boundary.adjacent.push_back(of.around(node));
      }
      face[std::size_t(k)] = entry->second;
      centre = plus(centre, scaled(1.0 / facet.corners, mesh.node(node)));
    }
    // A triangle is a quadrangle whose last corners coincide.
    if (facet.corners == 3) face[3] = face[2];
    boundary.face.push_back(face);
    boundary.sign.push_back(1.0);
    boundary.centre.push_back(centre);
  }
}

}  // namespace peristat
