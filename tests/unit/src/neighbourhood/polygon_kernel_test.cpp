#include "src/neighbourhood/polygon_kernel.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "src/geometry/lattice.hpp"
#include "src/neighbourhood/lattice_kernel.hpp"

namespace peristat {
namespace {

constexpr double pi = std::numbers::pi;

Lattice square(double cell_perturbation) {
  Lattice lattice;
  lattice.spacing = 0.1;
  lattice.cross_section = 0.02;
  lattice.shapes = {{ShapeStep::Action::add, Box{{-1, -1, 0}, {1, 1, 0}}}};
  lattice.cell_perturbation = cell_perturbation;
  return lattice;
}

Kernel kernel(double horizon, VolumeCorrection correction = VolumeCorrection::exact) {
  Kernel result;
  result.horizon = horizon;
  result.cross_section = 0.02;
  result.volume_correction = correction;
  return result;
}

bool is_inside(const Points& points, Index i, double margin) {
  const Coordinates at = points.position(i);
  return std::max(std::abs(at[0]), std::abs(at[1])) < 1.0 - margin;
}

// The cells fill the body without gap or overlap: their parts in a disk in it fill the disk, and
// have its middle. Own cells included, which no bond counts.
TEST(PolygonKernel, PartsFillTheHorizon) {
  Lattice random = square(0.0);
  random.arrangement = Arrangement::blue_noise;
  Lattice turned = square(0.24);
  turned.angle = 30.0;
  turned.shapes = {{ShapeStep::Action::add, Box{{-1.3, -1.3, 0}, {1.3, 1.3, 0}}}};
  for (const Lattice& lattice : {square(0.24), turned, random}) {
    const Points points = make_points(lattice);
    for (const double horizon : {0.3015, 0.42}) {
      const PolygonKernel of(points, kernel(horizon));
      int inside = 0;
      for (Index i = 0; i < points.count(); i += 7) {
        if (!is_inside(points, i, horizon + 0.01)) continue;
        double area = 0.0;
        PlaneVector moment{};
        for (Index j = 0; j < points.count(); ++j) {
          const PolygonPart part = of.part(j, i);
          area += part.area;
          for (std::size_t c = 0; c < 2; ++c) moment[c] += part.moment[c];
        }
        EXPECT_NEAR(area / (pi * horizon * horizon), 1.0, 1e-13);
        EXPECT_NEAR(moment[0] / std::pow(horizon, 3), 0.0, 1e-13);
        EXPECT_NEAR(moment[1] / std::pow(horizon, 3), 0.0, 1e-13);
        ++inside;
      }
      EXPECT_GT(inside, 10);
    }
  }
}

// Counted on a grid, nothing but who is inside: parts of single cells and their centroids.
TEST(PolygonKernel, PartsAreThoseOfAGrid) {
  const Points points = make_points(square(0.24));
  const double horizon = 0.3015;
  const PolygonKernel of(points, kernel(horizon));
  Index i = 0;
  while (!is_inside(points, i, 0.7)) ++i;
  int cut = 0;
  for (Index j = 0; j < points.count(); ++j) {
    const Coordinates a = points.position(i), b = points.position(j);
    const double distance = std::hypot(b[0] - a[0], b[1] - a[1]);
    if (std::abs(distance - horizon) > 0.06) continue;
    const auto corners = points.polygons.of(std::size_t(j));
    constexpr int fine = 800;
    const double step = 0.16 / fine;
    double area = 0.0, moment = 0.0, whole = 0.0;
    for (int x = 0; x < fine; ++x) {
      for (int y = 0; y < fine; ++y) {
        const double u = (x + 0.5) * step - 0.08, v = (y + 0.5) * step - 0.08;
        bool is_in_cell = true;
        for (std::size_t k = 0; k < corners.size(); ++k) {
          const auto &p = corners[k], &q = corners[(k + 1) % corners.size()];
          is_in_cell = is_in_cell && (q[0] - p[0]) * (v - p[1]) - (q[1] - p[1]) * (u - p[0]) >= 0.0;
        }
        if (!is_in_cell) continue;
        whole += step * step;
        const double at_x = b[0] - a[0] + u, at_y = b[1] - a[1] + v;
        if (std::hypot(at_x, at_y) > horizon) continue;
        area += step * step;
        moment += step * step * at_x;
      }
    }
    EXPECT_NEAR(whole, points.volume[std::size_t(j)] / 0.02, 2e-5);
    const PolygonPart part = of.part(j, i);
    EXPECT_NEAR(part.area, area, 2e-5);
    EXPECT_NEAR(part.moment[0], moment, 1e-5);
    ++cut;
  }
  EXPECT_GT(cut, 8);
}

// Squares are those of a lattice, with centroids and influence, too.
TEST(PolygonKernel, OfSquaresIsTheLatticeKernel) {
  const Points points = make_points(square(1e-13));
  for (const VolumeCorrection correction :
       {VolumeCorrection::exact, VolumeCorrection::exact_centroids}) {
    Kernel with_influence = kernel(0.3015, correction);
    with_influence.influence = [](double ratio) { return ratio < 1.0 ? 1.0 - 0.9 * ratio : 0.0; };
    const PolygonKernel polygons(points, with_influence);
    const LatticeKernel lattice(with_influence, points.spacing);
    Index i = 0;
    while (!is_inside(points, i, 0.7)) ++i;
    int seen = 0;
    for (Index j = 0; j < points.count(); ++j) {
      if (j == i) continue;
      const Coordinates a = points.position(i), b = points.position(j);
      const LatticeStep step{int(std::lround((b[0] - a[0]) / 0.1)),
                             int(std::lround((b[1] - a[1]) / 0.1)), 0};
      const double found = polygons.factor(i, j, std::hypot(b[0] - a[0], b[1] - a[1]));
      EXPECT_NEAR(found, lattice.factor(step), 1e-11);
      EXPECT_EQ(found, polygons.factor(j, i, std::hypot(b[0] - a[0], b[1] - a[1])));
      seen += found > 0.0;
    }
    EXPECT_GE(seen, 28);
  }
}

// On a line parts are intervals, which fill twice the horizon.
TEST(PolygonKernel, OfALineAreIntervals) {
  Lattice lattice;
  lattice.dimension = 1;
  lattice.spacing = 0.1;
  lattice.shapes = {{ShapeStep::Action::add, Box{{-1, 0, 0}, {1, 0, 0}}}};
  lattice.cell_perturbation = 0.24;
  const Points points = make_points(lattice);
  Kernel of_line = kernel(0.3015);
  of_line.dimension = 1;
  of_line.cross_section = 1.0;
  const PolygonKernel of(points, of_line);
  Index i = 0;
  while (std::abs(points.position(i)[0]) > 0.1) ++i;
  const auto share = [&](Index a, Index b) {  // of b's interval about a, from the ends of cells
    const double middle = points.reference[std::size_t(b)],
                 half = 0.5 * points.volume[std::size_t(b)],
                 from = points.reference[std::size_t(a)];
    const double low = std::max(middle - half, from - 0.3015),
                 high = std::min(middle + half, from + 0.3015);
    return std::max(0.0, high - low) / (2.0 * half);
  };
  double length = 0.0, moment = 0.0;
  int cut = 0;
  for (Index j = 0; j < points.count(); ++j) {
    const PolygonPart part = of.part(j, i);
    length += part.area;
    moment += part.moment[0];
    if (j == i) continue;
    const double distance = std::abs(points.position(j)[0] - points.position(i)[0]);
    const double both = 0.5 * (share(i, j) + share(j, i));
    EXPECT_NEAR(of.factor(i, j, distance), both, 1e-12);
    cut += both > 0.0 && both < 1.0;
  }
  EXPECT_GE(cut, 2);
  EXPECT_NEAR(length, 0.603, 1e-15);
  EXPECT_NEAR(moment, 0.0, 1e-16);
}

// Beyond a plane of symmetry cells are mirror images: the disk about a point near it is full.
TEST(PolygonKernel, ImagesHaveMirroredCells) {
  for (Lattice lattice : {square(0.24), square(0.0)}) {
    if (lattice.cell_perturbation == 0.0) lattice.arrangement = Arrangement::blue_noise;
    Points points = make_points(lattice);
    const double horizon = 0.3015;
    add_images(points, {{0, 1.0}}, {}, 0.5);
    ASSERT_LT(points.own(), points.count());
    const PolygonKernel of(points, kernel(horizon));
    int near = 0;
    for (Index i = 0; i < points.own(); ++i) {
      const Coordinates at = points.position(i);
      if (at[0] < 0.8 || std::abs(at[1]) > 0.6) continue;
      double area = 0.0;
      for (Index j = 0; j < points.count(); ++j) area += of.part(j, i).area;
      EXPECT_NEAR(area / (pi * horizon * horizon), 1.0, 1e-13);
      ++near;
    }
    EXPECT_GT(near, 10);
  }
}

}  // namespace
}  // namespace peristat
