#include "src/geometry/element_shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "src/core/coordinates.hpp"

namespace peristat {
namespace {

using ElementKind = MeshElements::Kind;

const std::vector<ElementShape>& element_shapes() {
  static const std::vector<ElementShape> shapes{
      {ElementKind::line, "line", "line", "lines", 1, 2, {0, 1}, {{0}, {1}}, {}, {1, 0}},
      {ElementKind::triangle,
       "triangle",
       "triangle",
       "triangles",
       2,
       3,
       {0, 1, 2, 2},
       {{0, 1}, {1, 2}, {2, 0}},
       {{0, 1, 2}},
       {0, 2, 1}},
      {ElementKind::quadrilateral,
       "quad",
       "quadrilateral",
       "quadrilaterals",
       2,
       4,
       {0, 1, 2, 3},
       {{0, 1}, {1, 2}, {2, 3}, {3, 0}},
       {{0, 1, 3}, {1, 2, 0}, {2, 3, 1}, {3, 0, 2}},
       {0, 3, 2, 1}},
      {ElementKind::tetrahedron,
       "tetra",
       "tetrahedron",
       "tetrahedra",
       3,
       4,
       {0, 1, 2, 2, 3, 3, 3, 3},
       {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
       {{0, 1, 2, 3}},
       {0, 2, 1, 3}},
      {ElementKind::hexahedron,
       "hexahedron",
       "hexahedron",
       "hexahedra",
       3,
       8,
       {0, 1, 2, 3, 4, 5, 6, 7},
       {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}},
       {{0, 1, 3, 4},
        {1, 2, 0, 5},
        {2, 3, 1, 6},
        {3, 0, 2, 7},
        {4, 7, 5, 0},
        {5, 4, 6, 1},
        {6, 5, 7, 2},
        {7, 6, 4, 3}},
       {0, 3, 2, 1, 4, 7, 6, 5}},
      {ElementKind::wedge,
       "wedge",
       "wedge",
       "wedges",
       3,
       6,
       {0, 1, 2, 2, 3, 4, 5, 5},
       {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}},
       {{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5}, {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}},
       {0, 2, 1, 3, 5, 4}},
      {ElementKind::pyramid,
       "pyramid",
       "pyramid",
       "pyramids",
       3,
       5,
       {0, 1, 2, 3, 4, 4, 4, 4},
       {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}},
       {{0, 1, 3, 4}, {1, 2, 0, 4}, {2, 3, 1, 4}, {3, 0, 2, 4}},
       {0, 3, 2, 1, 4}}};
  return shapes;
}

/// Signs of a cube's corners along its axes, in VTK's order.
constexpr std::array<std::array<double, 3>, 8> brick_signs{{{-1, -1, -1},
                                                            {1, -1, -1},
                                                            {1, 1, -1},
                                                            {-1, 1, -1},
                                                            {-1, -1, 1},
                                                            {1, -1, 1},
                                                            {1, 1, 1},
                                                            {-1, 1, 1}}};

double determinant(const std::array<Coordinates, 3>& of) { return dot(cross(of[0], of[1]), of[2]); }

/// Place x and determinant of J at a place u of the square or cube [-1, 1]^d.
struct AtGaussPoint {
  Coordinates place{};
  double determinant = 0.0;
};

AtGaussPoint at_gauss_point(const ElementShape& shape, std::span<const Coordinates> corners,
                            const std::array<double, 3>& u) {
  const int count = shape.dimension == 2 ? 4 : 8;
  AtGaussPoint at;
  std::array<Coordinates, 3> tangents{};
  if (shape.dimension == 2) tangents[2] = {0.0, 0.0, 1.0};
  for (int k = 0; k < count; ++k) {
    const Coordinates& corner = corners[std::size_t(shape.brick[std::size_t(k)])];
    std::array<double, 3> factor{1.0, 1.0, 1.0}, slope{};
    for (std::size_t c = 0; c < std::size_t(shape.dimension); ++c) {
      slope[c] = 0.5 * brick_signs[std::size_t(k)][c];
      factor[c] = 0.5 + slope[c] * u[c];
    }
    const double value = factor[0] * factor[1] * factor[2];
    at.place = plus(at.place, scaled(value, corner));
    for (std::size_t c = 0; c < std::size_t(shape.dimension); ++c) {
      const double others = factor[(c + 1) % 3] * factor[(c + 2) % 3];
      tangents[c] = plus(tangents[c], scaled(slope[c] * others, corner));
    }
  }
  at.determinant = determinant(tangents);
  return at;
}

}  // namespace

const ElementShape& shape_of(MeshElements::Kind kind) {
  const auto& all = element_shapes();
  return *std::ranges::find_if(all, [&](const ElementShape& one) { return one.kind == kind; });
}

const ElementShape* shape_of_type(const std::string& type) {
  const std::string name = type.substr(0, type.find_last_not_of("0123456789") + 1);
  for (const ElementShape& shape : element_shapes()) {
    if (name == shape.type) return &shape;
  }
  return nullptr;
}

ElementMeasure measure_of(const ElementShape& shape, std::span<const Coordinates> corners) {
  // Relative to the first corner, so that the distance from the origin costs no digits.
  std::vector<Coordinates> relative;
  for (const Coordinates& corner : corners) relative.push_back(minus(corner, corners[0]));
  const double gauss = 1.0 / std::sqrt(3.0);
  ElementMeasure result;
  for (int k = 0; k < 1 << shape.dimension; ++k) {
    const std::array<double, 3> u{k & 1 ? gauss : -gauss, k & 2 ? gauss : -gauss,
                                  shape.dimension == 2 ? 0.0
                                  : k & 4              ? gauss
                                                       : -gauss};
    const AtGaussPoint at = at_gauss_point(shape, relative, u);
    result.measure += at.determinant;
    result.centroid = plus(result.centroid, scaled(at.determinant, at.place));
  }
  result.centroid = plus(corners[0], scaled(1.0 / result.measure, result.centroid));
  for (std::size_t k = 0; k < shape.trihedra.size(); ++k) {
    const auto& [at, x, y, z] = shape.trihedra[k];
    std::array<Coordinates, 3> edges{minus(relative[std::size_t(x)], relative[std::size_t(at)]),
                                     minus(relative[std::size_t(y)], relative[std::size_t(at)]),
                                     {0.0, 0.0, 1.0}};
    if (shape.dimension == 3) edges[2] = minus(relative[std::size_t(z)], relative[std::size_t(at)]);
    const double here = determinant(edges);
    result.least = k == 0 ? here : std::min(result.least, here);
    result.largest = k == 0 ? here : std::max(result.largest, here);
  }
  return result;
}

}  // namespace peristat
