#include "src/geometry/mesh_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "src/core/coordinates.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/coincident_points.hpp"
#include "src/geometry/element_shape.hpp"
#include "src/geometry/mesh_sides.hpp"
#include "src/geometry/points.hpp"

namespace peristat {
namespace {

/// Measure of an element, relative to that of a square or cube on its longest edge, below which it
/// is flat.
constexpr double flat_element = 1e-9;

/// Distance of nodes, relative to the mean size of the elements, up to which they are at one place.
constexpr double same_node = 1e-6;

/// Largest coordinate [m]: beyond it, volumes and squares of distances might overflow.
constexpr double largest_coordinate = 1e50;

std::string count_words(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string count_words(std::size_t count, const ElementShape& shape) {
  return std::to_string(count) + " " + (count == 1 ? shape.name : shape.plural);
}

/// Elements of a file that are not yet checked.
class MeshReading {
 public:
  MeshReading(const Mesh& mesh, int dimension, const std::string& file)
      : mesh_(mesh), file_(file), body_(std::make_shared<MeshBody>()) {
    body_->dimension = dimension;
    body_->remarks = mesh.remarks;
  }

  std::shared_ptr<const MeshBody> read() {
    take_elements();
    refuse_missing_elements();
    take_nodes();
    measure_elements();
    refuse_nodes_at_one_place();
    find_mesh_boundary(*body_, file_);
    remark_idle_faces();
    take_groups();
    return body_;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { throw InputError("file", file_, what); }

  void take_elements() {
    MeshElements& elements = body_->elements;
    elements.offset.push_back(0);
    std::int64_t number = 0;
    for (const Mesh::Block& block : mesh_.blocks) {
      const std::size_t count =
          block.nodes_per_element == 0 ? 0 : block.nodes.size() / block.nodes_per_element;
      const ElementShape* const shape = shape_of_type(block.type);
      const bool is_vertex = block.type == "vertex";
      if (shape == nullptr && !is_vertex && count > 0) {
        refuse("element " + std::to_string(number + 1) + " of the file has the type " + block.type +
               ", which is not supported; triangles, quadrilaterals, tetrahedra, hexahedra, "
               "wedges and pyramids are");
      }
      const std::size_t corners = is_vertex || shape == nullptr ? 1 : std::size_t(shape->corners);
      if (count > 0 && block.nodes_per_element < corners)
        refuse("elements of type " + block.type + " have " +
               count_words(block.nodes_per_element, "node"));
      const int of_dimension = is_vertex || shape == nullptr ? 0 : shape->dimension;
      count_of_[std::size_t(of_dimension)] += count;
      if (block.nodes_per_element > corners && of_dimension == body_->dimension) curved_ += count;
      for (std::size_t e = 0; e < count; ++e, ++number) {
        const auto first = block.nodes.begin() + std::ptrdiff_t(e * block.nodes_per_element);
        take_element(shape, of_dimension, number, {first, first + std::ptrdiff_t(corners)});
      }
    }
  }

  void take_element(const ElementShape* shape, int of_dimension, std::int64_t number,
                    const std::vector<std::int64_t>& nodes) {
    const std::string words = "element " + std::to_string(number + 1) + " of the file";
    const std::size_t count = mesh_.nodes.size() / 3;
    if (number >= std::numeric_limits<Index>::max() || count >= std::size_t(1) << 31)
      refuse("has more than 2^31 elements or nodes");
    std::vector<Index> corners;
    for (const std::int64_t node : nodes) {
      if (node < 0 || std::size_t(node) >= count)
        refuse(words + " has a node that the file does not define (it defines " +
               count_words(count, "node") + ")");
      if (std::find(corners.begin(), corners.end(), Index(node)) != corners.end())
        refuse(words + " has node " + std::to_string(node + 1) +
               " at two corners; write it as an element with fewer corners");
      corners.push_back(Index(node));
    }
    place_in_body_.push_back(-1);
    if (of_dimension < body_->dimension) {
      lower_.emplace_back(number, std::move(corners));
    } else if (of_dimension == body_->dimension) {
      place_in_body_.back() = Index(body_->count());
      body_->elements.kind.push_back(shape->kind);
      body_->elements.corners.insert(body_->elements.corners.end(), corners.begin(), corners.end());
      body_->elements.offset.push_back(body_->elements.corners.size());
      body_->file_element.push_back(std::int32_t(number));
    }
  }

  void refuse_missing_elements() {
    const auto d = std::size_t(body_->dimension);
    constexpr std::array<const char*, 4> kinds{"vertices", "lines", "faces", "solids"};
    if (body_->dimension == 2 && count_of_[3] > 0)
      refuse("has " + count_words(count_of_[3], "solid element") +
             ", but the case has dimension = 2");
    if (body_->count() == 0) {
      std::string found;
      for (std::size_t k = 0; k < 4; ++k) {
        if (count_of_[k] > 0)
          found += (found.empty() ? "" : ", ") + std::to_string(count_of_[k]) + " " + kinds[k];
      }
      refuse(
          "has no elements of dimension " + std::to_string(d) + ", which are " +
          (d == 2 ? "triangles and quadrilaterals" : "tetrahedra, hexahedra, wedges and pyramids") +
          "; it has " + (found.empty() ? "no elements at all" : found));
    }
    if (curved_ > 0)
      body_->remarks.push_back(count_words(curved_, "element") +
                               " of second order are read only by their corners, so their sides "
                               "become straight (plane or bilinear)");
  }

  void take_nodes() {
    const auto d = std::size_t(body_->dimension);
    const std::size_t count = mesh_.nodes.size() / 3;
    is_used_.assign(count, 0);
    for (const Index node : body_->elements.corners) is_used_[std::size_t(node)] = 1;
    double lowest = infinity_, highest = -infinity_, extent = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        const double at = mesh_.nodes[3 * k + c];
        if (is_used_[k] && !(std::abs(at) < largest_coordinate))
          refuse("node " + std::to_string(k + 1) + " of the file has " + "xyz"[c] + " = " +
                 number_text(at) + "; coordinates must be finite and below " +
                 number_text(largest_coordinate));
        if (c < d) body_->elements.nodes.push_back(at);
        if (is_used_[k] && c < d) extent = std::max(extent, std::abs(at));
      }
      if (!is_used_[k]) continue;
      lowest = std::min(lowest, mesh_.nodes[3 * k + 2]);
      highest = std::max(highest, mesh_.nodes[3 * k + 2]);
    }
    if (d == 2 && highest - lowest > 1e-9 * extent)
      refuse("has z from " + number_text(lowest) + " to " + number_text(highest) +
             ", but dimension = 2 needs elements in one plane z = constant");
  }

  void measure_elements() {
    std::size_t mirrored = 0;
    body_->centroid.resize(body_->count());
    body_->measure.resize(body_->count());
    for (std::size_t e = 0; e < body_->count(); ++e) {
      const ElementShape& shape = shape_of(body_->elements.kind[e]);
      std::vector<Coordinates> corners;
      double longest = 0.0;
      Coordinates mean{};
      const std::vector<Index> nodes = body_->corners_of(e);
      for (const Index node : nodes) {
        corners.push_back(body_->node(node));
        longest = std::max(longest, length(minus(corners.back(), corners[0])));
        mean = plus(mean, scaled(1.0 / double(nodes.size()), corners.back()));
      }
      const ElementMeasure of = measure_of(shape, corners);
      const double flat = flat_element * std::pow(longest, body_->dimension);
      body_->centroid[e] = mean;  // for messages
      const double sign = of.measure > 0.0 ? 1.0 : -1.0;
      const double worst = sign > 0.0 ? of.least : -of.largest;
      if (worst < -flat)
        refuse(element_text(*body_, e) +
               " is twisted or not convex: its corners are in a wrong order, or one lies inside");
      if (!(std::abs(of.measure) > flat) || !(worst > flat))
        refuse(element_text(*body_, e) + (body_->dimension == 2
                                              ? " has no area, or none at a corner"
                                              : " has no volume, or none at a corner"));
      body_->centroid[e] = of.centroid;
      body_->measure[e] = std::abs(of.measure);
      if (sign > 0.0) continue;
      ++mirrored;
      const std::size_t first = body_->elements.offset[e];
      for (std::size_t k = 0; k < nodes.size(); ++k)
        body_->elements.corners[first + k] = nodes[std::size_t(shape.mirrored[k])];
    }
    if (mirrored > 0 && mirrored < body_->count())
      body_->remarks.push_back(
          count_words(mirrored, "element") + " of " + std::to_string(body_->count()) +
          " are numbered in the opposite direction; they are read like the others");
  }

  /// Refuses nodes at one place: elements that do not share them are not joined.
  void refuse_nodes_at_one_place() const {
    double mean = 0.0;
    for (const double measure : body_->measure) mean += measure / double(body_->count());
    const double cell = std::pow(mean, 1.0 / body_->dimension);
    Points nodes;
    nodes.dimension = body_->dimension;
    std::vector<Index> numbers;
    for (std::size_t k = 0; k < is_used_.size(); ++k) {
      if (!is_used_[k]) continue;
      const Coordinates at = body_->node(Index(k));
      nodes.reference.insert(nodes.reference.end(), at.begin(), at.begin() + body_->dimension);
      nodes.volume.push_back(1.0);
      numbers.push_back(Index(k));
    }
    const auto pair = points_at_one_place(nodes, same_node * cell);
    if (!pair) return;
    refuse(node_text(*body_, numbers[std::size_t(pair->second)]) + " has the position of node " +
           std::to_string(numbers[std::size_t(pair->first)] + 1) +
           ": elements are joined only by common nodes, so the body would be separated there; "
           "merge the nodes, and give a crack as [[crack]]");
  }

  /// Shells and the like are no part of the body.
  void remark_idle_faces() {
    const std::size_t corners_of_line = 2;
    std::vector<std::vector<Index>> around(body_->node_count());
    for (std::size_t e = 0; e < body_->count(); ++e)
      for (const Index node : body_->corners_of(e)) around[std::size_t(node)].push_back(Index(e));
    const auto idle = std::ranges::count_if(lower_, [&](const auto& element) {
      const std::vector<Index>& nodes = element.second;
      const bool is_side = (nodes.size() == corners_of_line) == (body_->dimension == 2);
      return is_side && nodes.size() > 1 &&
             std::ranges::none_of(around[std::size_t(nodes[0])], [&](Index e) {
               const std::vector<Index> corners = body_->corners_of(std::size_t(e));
               return std::ranges::all_of(
                   nodes, [&](Index node) { return std::ranges::count(corners, node) > 0; });
             });
    });
    if (idle > 0)
      body_->remarks.push_back(
          count_words(std::size_t(idle), body_->dimension == 2 ? "line" : "face") +
          " that are not a side of an element are left out");
  }

  /// Refuses names that tables and datasets of results can't have.
  void check_group_name(const std::string& name, bool is_of_nodes) const {
    const std::string what = is_of_nodes ? "a group of nodes" : "a group of elements";
    if (name.empty()) refuse("has " + what + " without a name; give it one");
    const bool is_plain = std::all_of(name.begin(), name.end(), [](unsigned char letter) {
      return letter >= ' ' && letter != 127 && letter != ',' && letter != '|' && letter != '"' &&
             letter != '#';
    });
    if (!is_plain || name == "." || name.size() > 100 || name.front() == ' ' || name.back() == ' ')
      refuse("has " + what + " called \"" + name +
             "\"; use a name of at most 100 letters, digits, _ and -");
  }

  void take_groups() {
    std::set<std::pair<std::string, bool>> names;
    for (const Mesh::Group& group : mesh_.groups) {
      check_group_name(group.name, group.is_of_nodes);
      if (!names.emplace(group.name, group.is_of_nodes).second)
        refuse("has two groups called \"" + group.name + "\"; give them different names");
    }
    for (const Mesh::Group& group : mesh_.groups) {
      if (group.is_of_nodes && names.contains({group.name, false})) {
        body_->remarks.push_back("group " + group.name +
                                 ": the elements of this name are used, not the nodes");
        continue;
      }
      take_group(group, body_->groups[group.name]);
    }
  }

  void take_group(const Mesh::Group& group, MeshBody::Group& taken) const {
    for (const std::int64_t member : group.members) {
      const auto all = std::int64_t(group.is_of_nodes ? is_used_.size() : place_in_body_.size());
      if (member < 0 || member >= all)
        refuse("group \"" + group.name + "\" has " + (group.is_of_nodes ? "a node" : "an element") +
               " that the file does not define");
      if (group.is_of_nodes) {
        if (is_used_[std::size_t(member)]) taken.nodes.push_back(Index(member));
      } else if (place_in_body_[std::size_t(member)] >= 0) {
        taken.elements.push_back(place_in_body_[std::size_t(member)]);
      } else {
        const auto found = std::lower_bound(
            lower_.begin(), lower_.end(), member,
            [](const auto& element, std::int64_t number) { return element.first < number; });
        if (found != lower_.end() && found->first == member) taken.lower.push_back(found->second);
      }
    }
  }

  static constexpr double infinity_ = std::numeric_limits<double>::infinity();

  const Mesh& mesh_;
  const std::string& file_;
  std::shared_ptr<MeshBody> body_;
  std::array<std::size_t, 4> count_of_{};  // elements by dimension
  std::size_t curved_ = 0;
  std::vector<Index> place_in_body_;  // of each element of the file; -1: of another dimension
  std::vector<std::pair<std::int64_t, std::vector<Index>>> lower_;  // number, nodes
  std::vector<char> is_used_;
};

}  // namespace

std::string element_counts(const MeshBody& mesh) {
  std::map<MeshElements::Kind, std::size_t> counts;
  for (const MeshElements::Kind kind : mesh.elements.kind) ++counts[kind];
  std::string text;
  for (const auto& [kind, count] : counts)
    text += (text.empty() ? "" : ", ") + count_words(count, shape_of(kind));
  return text;
}

std::shared_ptr<const MeshBody> make_mesh_body(const Mesh& mesh, int dimension,
                                               const std::string& file) {
  if (dimension != 2 && dimension != 3)
    throw InputError("file", file, "meshes are for dimension 2 and 3");
  return MeshReading(mesh, dimension, file).read();
}

}  // namespace peristat
