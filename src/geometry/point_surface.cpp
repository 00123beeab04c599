#include "src/geometry/point_surface.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include "src/core/coordinates.hpp"

namespace peristat {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Plane =
    CGAL::Delaunay_triangulation_2<Kernel,
                                   CGAL::Triangulation_data_structure_2<
                                       CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel>>>;
using Space = CGAL::Delaunay_triangulation_3<
    Kernel,
    CGAL::Triangulation_data_structure_3<CGAL::Triangulation_vertex_base_with_info_3<Index, Kernel>,
                                         CGAL::Delaunay_triangulation_cell_base_3<Kernel>>>;

constexpr double largest_radius = 1.25;  // over the size of a corner
constexpr double flat = 1e-6;            // volume over the cube of the size

template <std::size_t N>
struct Corners {
  std::array<Index, N> point;
};

Corners<3> corners_of(const Plane::Face_handle& face) {
  return {{face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()}};
}
Corners<4> corners_of(const Space::Cell_handle& cell) {
  return {{cell->vertex(0)->info(), cell->vertex(1)->info(), cell->vertex(2)->info(),
           cell->vertex(3)->info()}};
}

/// Ratio of the circumscribed radius to a size; 0 for simplices that are flat to round-off, which
/// Delaunay triangulations of lattices have between others.
double relative_radius(const Plane::Face_handle& face, double size) {
  const auto& a = face->vertex(0)->point();
  const auto& b = face->vertex(1)->point();
  const auto& c = face->vertex(2)->point();
  if (std::abs(CGAL::area(a, b, c)) < flat * size * size) return 0.0;
  return std::sqrt(CGAL::squared_radius(a, b, c)) / size;
}
double relative_radius(const Space::Cell_handle& cell, double size) {
  const auto& a = cell->vertex(0)->point();
  const auto& b = cell->vertex(1)->point();
  const auto& c = cell->vertex(2)->point();
  const auto& d = cell->vertex(3)->point();
  if (std::abs(CGAL::volume(a, b, c, d)) < flat * size * size * size) return 0.0;
  return std::sqrt(CGAL::squared_radius(a, b, c, d)) / size;
}

/// The facets of simplices that are part of the body and of one of these alone.
template <std::size_t N, class Handles>
std::vector<FacetCorners> boundary_of(const Handles& simplices, std::span<const double> size,
                                      const std::function<bool(Index, Index)>& are_joined) {
  std::vector<FacetCorners> sides;
  for (auto simplex : simplices) {
    auto [corner] = corners_of(simplex);
    double largest = 0.0;
    bool is_part = true;
    for (std::size_t a = 0; a < N && is_part; ++a) {
      largest = std::max(largest, size[std::size_t(corner[a])]);
      for (std::size_t b = 0; b < a && is_part; ++b) is_part = are_joined(corner[a], corner[b]);
    }
    if (!is_part || relative_radius(simplex, largest) > largest_radius) continue;
    std::ranges::sort(corner);
    for (std::size_t left_out = 0; left_out < N; ++left_out) {
      FacetCorners side{-1, -1, -1};
      for (std::size_t a = 0, k = 0; a < N; ++a) {
        if (a != left_out) side[k++] = corner[a];
      }
      sides.push_back(side);
    }
  }
  std::ranges::sort(sides);
  std::vector<FacetCorners> boundary;
  for (auto from = sides.begin(); from != sides.end();) {
    const auto to = std::find_if(from, sides.end(), [&](const auto& of) { return of != *from; });
    if (to - from == 1) boundary.push_back(*from);
    from = to;
  }
  return boundary;
}

/// Places of points that move apart across cuts, by up to a twentieth of a size per unjoined side.
/// The points of a lattice's cell stand on one circle, so that round-off chooses its diagonal. A
/// cut through the cell leaves a straight face only with the diagonal along it.
class SpreadPlaces {
 public:
  SpreadPlaces(const Points& points, std::span<const double> size,
               const std::function<bool(Index, Index)>& are_joined)
      : size_(size), are_joined_(are_joined), rest_(std::size_t(points.count())) {
    for (Index i = 0; i < points.count(); ++i) rest_[std::size_t(i)] = points.position(i);
    place_ = rest_;
  }
  [[nodiscard]] const std::vector<Coordinates>& places() const { return place_; }

  /// Moves the ends of a side of a simplex apart if it is short and not joined.
  void spread(Index i, Index j) {
    constexpr double longest = 1.5, share = 0.05;
    const double size = std::min(size_[std::size_t(i)], size_[std::size_t(j)]);
    const Coordinates arm = minus(rest_[std::size_t(j)], rest_[std::size_t(i)]);
    const double distance = length(arm);
    if (distance > longest * size || are_joined_(i, j)) return;
    const Coordinates step = scaled(share * size / distance, arm);
    place_[std::size_t(j)] = plus(place_[std::size_t(j)], step);
    place_[std::size_t(i)] = minus(place_[std::size_t(i)], step);
  }

 private:
  std::span<const double> size_;
  const std::function<bool(Index, Index)>& are_joined_;
  std::vector<Coordinates> rest_, place_;
};

Plane triangulate_plane(const std::vector<Coordinates>& places) {
  std::vector<std::pair<Kernel::Point_2, Index>> numbered;
  for (const Coordinates& at : places) {
    numbered.emplace_back(Kernel::Point_2(at[0], at[1]), Index(numbered.size()));
  }
  return {numbered.begin(), numbered.end()};
}

Space triangulate_space(const std::vector<Coordinates>& places) {
  std::vector<std::pair<Kernel::Point_3, Index>> numbered;
  for (const Coordinates& at : places) {
    numbered.emplace_back(Kernel::Point_3(at[0], at[1], at[2]), Index(numbered.size()));
  }
  return {numbered.begin(), numbered.end()};
}

}  // namespace

std::vector<FacetCorners> surface_of_points(const Points& points, std::span<const double> size,
                                            const std::function<bool(Index, Index)>& are_joined) {
  SpreadPlaces spread(points, size, are_joined);
  if (points.dimension == 2) {
    const Plane first = triangulate_plane(spread.places());
    for (const Plane::Edge& edge : first.finite_edges()) {
      const auto& [face, side] = edge;
      spread.spread(face->vertex((side + 1) % 3)->info(), face->vertex((side + 2) % 3)->info());
    }
    const Plane plane = triangulate_plane(spread.places());
    return boundary_of<3>(plane.finite_face_handles(), size, are_joined);
  }
  if (points.dimension == 3) {
    const Space first = triangulate_space(spread.places());
    for (const Space::Edge& edge : first.finite_edges()) {
      spread.spread(edge.first->vertex(edge.second)->info(),
                    edge.first->vertex(edge.third)->info());
    }
    const Space space = triangulate_space(spread.places());
    if (space.dimension() < 3) return {};
    return boundary_of<4>(space.finite_cell_handles(), size, are_joined);
  }
  return {};
}

}  // namespace peristat
