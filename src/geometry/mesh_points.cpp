#include "src/geometry/mesh_points.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "src/core/coordinates.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/coincident_points.hpp"
#include "src/geometry/mesh_interior.hpp"
#include "src/geometry/mesh_sides.hpp"
#include "src/geometry/numbering.hpp"

namespace peristat {
namespace {

/// Lists of the elements that have each node.
class ElementsOfNodes {
 public:
  explicit ElementsOfNodes(const MeshBody& mesh) : of_(mesh.node_count()) {
    for (std::size_t e = 0; e < mesh.count(); ++e)
      for (const Index node : mesh.corners_of(e)) of_[std::size_t(node)].push_back(Index(e));
  }
  [[nodiscard]] const std::vector<Index>& of(Index node) const { return of_[std::size_t(node)]; }

  /// Elements that have all of some nodes, ascending.
  [[nodiscard]] std::vector<Index> with_all(const std::vector<Index>& nodes) const {
    std::vector<Index> common = of(nodes.front());
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      std::vector<Index> both;
      std::ranges::set_intersection(common, of(nodes[k]), std::back_inserter(both));
      common = std::move(both);
    }
    return common;
  }

 private:
  std::vector<std::vector<Index>> of_;
};

void sort_without_doubles(std::vector<Index>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// Elements of a group, or its nodes.
std::vector<Index> members_of(const MeshBody& mesh, const MeshBody::Group& group, PointsAt at,
                              const ElementsOfNodes& around) {
  std::vector<Index> members;
  const auto add = [&](const std::vector<Index>& more) {
    members.insert(members.end(), more.begin(), more.end());
  };
  if (at == PointsAt::elements) {
    add(group.elements);
    for (const std::vector<Index>& nodes : group.lower) add(around.with_all(nodes));
    for (const Index node : group.nodes) add(around.of(node));
  } else {
    for (const Index element : group.elements) add(mesh.corners_of(std::size_t(element)));
    for (const std::vector<Index>& nodes : group.lower) add(nodes);
    add(group.nodes);
    std::erase_if(members, [&](Index node) { return around.of(node).empty(); });
  }
  sort_without_doubles(members);
  return members;
}

/// Places and volumes of all elements, or of all nodes that elements have.
struct Sites {
  std::vector<Index> number;  // of the element or node
  std::vector<double> reference, volume;
};

Sites sites_of(const MeshBody& mesh, PointsAt at, double cross_section) {
  Sites sites;
  std::vector<double> share(at == PointsAt::elements ? 0 : mesh.node_count(), 0.0);
  const auto add = [&](Index number, const Coordinates& place, double volume) {
    sites.number.push_back(number);
    sites.reference.insert(sites.reference.end(), place.begin(), place.begin() + mesh.dimension);
    sites.volume.push_back(cross_section * volume);
  };
  for (std::size_t e = 0; e < mesh.count(); ++e) {
    if (at == PointsAt::elements) add(Index(e), mesh.centroid[e], mesh.measure[e]);
    const std::vector<Index> corners = mesh.corners_of(e);
    for (const Index node : corners) {
      if (at == PointsAt::nodes)
        share[std::size_t(node)] += mesh.measure[e] / double(corners.size());
    }
  }
  for (std::size_t node = 0; node < share.size(); ++node)
    if (share[node] > 0.0) add(Index(node), mesh.node(Index(node)), share[node]);
  return sites;
}

void append_element(const MeshBody& mesh, std::size_t element, Points& points) {
  MeshElements& elements = points.elements;
  if (elements.offset.empty()) elements.offset.push_back(0);
  const std::vector<Index> corners = mesh.corners_of(element);
  elements.kind.push_back(mesh.elements.kind[element]);
  elements.corners.insert(elements.corners.end(), corners.begin(), corners.end());
  elements.offset.push_back(elements.corners.size());
  if (mesh.dimension != 2) return;
  std::vector<std::array<double, 2>> polygon;
  for (const Index node : corners) {
    const Coordinates from_point = minus(mesh.node(node), mesh.centroid[element]);
    polygon.push_back({from_point[0], from_point[1]});
  }
  points.polygons.append(polygon);
}

}  // namespace

Points make_points(std::shared_ptr<const MeshBody> of, PointsAt at, double cross_section,
                   const std::string& file) {
  if (!std::isfinite(cross_section) || !(cross_section > 0))
    throw InputError("cross_section", number_text(cross_section), "must be positive and finite");
  const MeshBody& mesh = *of;
  const Sites sites = sites_of(mesh, at, cross_section);
  Points points;
  points.dimension = mesh.dimension;
  double mean = 0.0;
  for (const double volume : sites.volume) mean += volume / double(sites.volume.size());
  points.spacing = std::pow(mean / cross_section, 1.0 / mesh.dimension);
  if (!std::isfinite(points.spacing) || !(points.spacing > 0))
    throw InputError("file", file,
                     "the mean volume " + number_text(mean) + " gives no usable spacing");

  std::map<Index, Index> point_of;  // by number of element or node
  for (const Index site : locality_order(mesh.dimension, points.spacing, sites.reference)) {
    const auto k = std::size_t(site);
    const Index number = sites.number[k];
    point_of[number] = points.count();
    const auto first = sites.reference.begin() + std::ptrdiff_t(k) * mesh.dimension;
    points.reference.insert(points.reference.end(), first, first + mesh.dimension);
    points.volume.push_back(sites.volume[k]);
    const bool is_element = at == PointsAt::elements;
    points.source_row.push_back(is_element ? mesh.file_element[std::size_t(number)] : number);
    if (is_element) append_element(mesh, std::size_t(number), points);
  }
  if (at == PointsAt::elements) points.elements.nodes = mesh.elements.nodes;
  if (const auto pair = points_at_one_place(points, same_place_tolerance * points.spacing)) {
    const auto text = [&](Index point) {
      const auto found =
          std::ranges::find(mesh.file_element, points.source_row[std::size_t(point)]);
      return element_text(mesh, std::size_t(found - mesh.file_element.begin()));
    };
    throw InputError("file", file,
                     text(pair->first) + " and " + text(pair->second) + " have the same centroid");
  }
  const ElementsOfNodes around(mesh);
  for (const auto& [name, group] : mesh.groups) {
    std::vector<Index> members = members_of(mesh, group, at, around);
    for (Index& member : members) member = point_of.at(member);
    std::sort(members.begin(), members.end());
    if (!members.empty()) points.sets[name] = std::move(members);
  }
  points.mesh = std::move(of);
  return points;
}

std::vector<std::size_t> facets_of(const MeshBody& mesh, const std::string& name) {
  const auto group = mesh.groups.find(name);
  if (group == mesh.groups.end()) return {};
  std::vector<std::vector<Index>> wanted = group->second.lower;
  for (std::vector<Index>& nodes : wanted) std::sort(nodes.begin(), nodes.end());
  std::sort(wanted.begin(), wanted.end());
  std::vector<std::size_t> facets;
  for (std::size_t f = 0; f < mesh.boundary.size(); ++f) {
    const MeshBody::Facet& facet = mesh.boundary[f];
    std::vector<Index> nodes(facet.corner.begin(), facet.corner.begin() + facet.corners);
    std::sort(nodes.begin(), nodes.end());
    if (std::binary_search(wanted.begin(), wanted.end(), nodes)) facets.push_back(f);
  }
  return facets;
}

}  // namespace peristat
