#include "src/geometry/voronoi.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <voro++/voro++.hh>

#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

/// Faces of a cell as lists of its corners.
std::vector<std::vector<std::size_t>> faces_of(voro::voronoicell& found) {
  std::vector<int> lists;  // per face its number of corners, then these
  found.face_vertices(lists);
  std::vector<std::vector<std::size_t>> faces;
  for (std::size_t at = 0; at < lists.size(); at += std::size_t(lists[at]) + 1) {
    faces.emplace_back(lists.begin() + std::ptrdiff_t(at) + 1,
                       lists.begin() + std::ptrdiff_t(at) + 1 + lists[at]);
  }
  return faces;
}

std::vector<Coordinates> corners_of(voro::voronoicell& found) {
  std::vector<double> flat;
  found.vertices(flat);
  std::vector<Coordinates> corners(flat.size() / 3);
  for (std::size_t k = 0; k < flat.size(); ++k) corners[k / 3][k % 3] = flat[k];
  return corners;
}

/// The polygon that a prism stands on: its upper face, anticlockwise.
std::vector<Coordinates> outline_of(voro::voronoicell& prism) {
  const std::vector<Coordinates> all = corners_of(prism);
  for (const std::vector<std::size_t>& face : faces_of(prism)) {
    const bool is_upper = std::all_of(face.begin(), face.end(),
                                      [&](std::size_t corner) { return all[corner][2] > 0.0; });
    if (!is_upper) continue;
    std::vector<Coordinates> outline;
    for (const std::size_t corner : face) outline.push_back({all[corner][0], all[corner][1], 0.0});
    double twice = 0.0;
    for (std::size_t k = 0; k < outline.size(); ++k)
      twice += cross(outline[k], outline[(k + 1) % outline.size()])[2];
    if (twice < 0.0) std::reverse(outline.begin(), outline.end());
    return outline;
  }
  throw std::logic_error("a Voronoi cell without an outline");
}

void set_polygon(ConvexCell& cell, const std::vector<Coordinates>& outline) {
  cell.corners = outline;
  Coordinates moment{};
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Coordinates &from = outline[k], &to = outline[(k + 1) % outline.size()];
    const double twice = cross(from, to)[2];
    cell.volume += 0.5 * twice;
    moment = plus<3>(moment, scaled<3>(twice / 6.0, plus<3>(from, to)));
  }
  cell.centroid = scaled<3>(1.0 / cell.volume, moment);
}

void set_polyhedron(ConvexCell& cell, voro::voronoicell& found) {
  cell.corners = corners_of(found);
  cell.faces = faces_of(found);
  cell.volume = found.volume();
  found.centroid(cell.centroid[0], cell.centroid[1], cell.centroid[2]);
}

/// Converts a cell from spacings to metres.
void scale(ConvexCell& cell, double spacing) {
  for (Coordinates& corner : cell.corners) corner = scaled<3>(spacing, corner);
  for (int c = 0; c < cell.dimension; ++c) cell.volume *= spacing;
  cell.centroid = plus<3>(cell.place, scaled<3>(spacing, cell.centroid));
}

}  // namespace

void for_each_voronoi_cell(int dimension, const Box& box, double spacing,
                           const std::vector<Coordinates>& places,
                           const std::function<void(std::size_t, const ConvexCell&)>& visit) {
  Coordinates size{1.0, 1.0, 1.0};  // in spacings; a plane is a slice of thickness 1
  std::array<int, 3> blocks{1, 1, 1};
  double cells = 1.0;
  for (int c = 0; c < dimension; ++c) {
    size[std::size_t(c)] = (box.max[std::size_t(c)] - box.min[std::size_t(c)]) / spacing;
    cells *= size[std::size_t(c)];
  }
  // Block size for which Voro++ is fastest if the places are spread evenly over the box.
  const double edge = std::pow(voro::optimal_particles * cells / double(places.size() + 1),
                               1.0 / double(dimension));
  for (std::size_t c = 0; c < std::size_t(dimension); ++c)
    blocks[c] = int(std::clamp(size[c] / edge, 1.0, 1e5));
  voro::container container(0.0, size[0], 0.0, size[1], 0.0, size[2], blocks[0], blocks[1],
                            blocks[2], false, false, false, 8);
  for (std::size_t k = 0; k < places.size(); ++k) {
    Coordinates at{0.5, 0.5, 0.5};
    for (std::size_t c = 0; c < std::size_t(dimension); ++c)
      at[c] = std::clamp((places[k][c] - box.min[c]) / spacing, 0.0, size[c]);
    container.put(int(k), at[0], at[1], at[2]);
  }

  std::size_t visited = 0;
  voro::voronoicell found;
  voro::c_loop_all loop(container);
  if (loop.start()) {
    do {
      if (!container.compute_cell(found, loop)) continue;
      const auto number = std::size_t(loop.pid());
      ConvexCell cell;
      cell.dimension = dimension;
      cell.place = places[number];
      if (dimension == 2) {
        set_polygon(cell, outline_of(found));
      } else {
        set_polyhedron(cell, found);
      }
      scale(cell, spacing);
      visit(number, cell);
      ++visited;
    } while (loop.inc());
  }
  if (visited != places.size()) throw std::logic_error("a place without a Voronoi cell");
}

}  // namespace peristat
