#include "src/geometry/box_in_ball.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <boost/math/quadrature/gauss.hpp>
#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

constexpr double pi = std::numbers::pi;

/// What the boxes of a lattice about the origin have of a ball: measure and first moments.
struct Total {
  double measure = 0.0;
  Coordinates moment{};
};

Total all_boxes(const Coordinates& edges, double radius, int dimension) {
  std::array<int, 3> width{};
  double size = 1.0;
  for (int c = 0; c < dimension; ++c) {
    width[std::size_t(c)] = int(radius / edges[std::size_t(c)]) + 1;
    size *= edges[std::size_t(c)];
  }
  Total total;
  for (int x = -width[0]; x <= width[0]; ++x) {
    for (int y = -width[1]; y <= width[1]; ++y) {
      for (int z = -width[2]; z <= width[2]; ++z) {
        const Coordinates at{x * edges[0], y * edges[1], z * edges[2]};
        const BoxPart part = box_in_ball(at, edges, radius, dimension);
        EXPECT_GE(part.share, 0.0);
        EXPECT_LE(part.share, 1.0);
        total.measure += part.share * size;
        for (std::size_t c = 0; c < 3; ++c) {
          total.moment[c] += part.share * size * part.centroid[c];
        }
      }
    }
  }
  return total;
}

// Round-off of each part is that of its box, and they are up to some thousands.
TEST(BoxInBall, PartsAddUpToTheBall) {
  for (const double ratio : {1.0, 1.5, 2.0, 3.0, 3.015, 4.0, 6.0, 6.5, 10.0, 20.3}) {
    const Total plane = all_boxes({1.0, 1.0, 0.0}, ratio, 2);
    EXPECT_NEAR(plane.measure / (pi * ratio * ratio), 1.0, 1e-14) << ratio;
    EXPECT_NEAR(plane.moment[0], 0.0, 1e-14 * std::pow(ratio, 3));
    const Total oblong = all_boxes({1.0, 0.6, 0.0}, ratio, 2);
    EXPECT_NEAR(oblong.measure / (pi * ratio * ratio), 1.0, 1e-14) << ratio;
    const Total line = all_boxes({0.7, 0.0, 0.0}, ratio, 1);
    EXPECT_NEAR(line.measure / (2.0 * ratio), 1.0, 1e-14) << ratio;
  }
  for (const double ratio : {1.0, 2.0, 3.0, 3.015, 5.0}) {
    const Total cubes = all_boxes({1.0, 1.0, 1.0}, ratio, 3);
    EXPECT_NEAR(cubes.measure / (4.0 / 3.0 * pi * std::pow(ratio, 3)), 1.0, 1e-14) << ratio;
    EXPECT_NEAR(cubes.moment[2], 0.0, 1e-13 * std::pow(ratio, 3));
  }
  const Total boxes = all_boxes({1.0, 0.7, 0.8}, 3.015, 3);
  EXPECT_NEAR(boxes.measure / (4.0 / 3.0 * pi * std::pow(3.015, 3)), 1.0, 1e-14);
}

/// int of a function with roots at the ends, which x = middle - half cos(t) makes smooth.
template <class Function>
double integral(const Function& of, double from, double to) {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  return boost::math::quadrature::gauss<double, 100>::integrate(
      [&](double t) { return half * std::sin(t) * of(middle - half * std::cos(t)); }, 0.0, pi);
}

/// Area and moments of a rectangle in a disk as integrals of its chords along y.
PolygonPart by_chords(const Coordinates& centre, const Coordinates& edges, double radius) {
  const double x0 = centre[0] - 0.5 * edges[0], x1 = centre[0] + 0.5 * edges[0];
  const double y0 = centre[1] - 0.5 * edges[1], y1 = centre[1] + 0.5 * edges[1];
  std::vector<double> kinks{std::max(x0, -radius), std::min(x1, radius)};
  for (const double y : {y0, y1}) {
    const double x = std::sqrt(std::max(radius * radius - y * y, 0.0));
    for (const double at : {-x, x}) {
      if (at > kinks[0] && at < kinks[1]) kinks.push_back(at);
    }
  }
  std::ranges::sort(kinks);
  PolygonPart part;
  const auto chord = [&](double x) {
    const double half = std::sqrt(std::max(radius * radius - x * x, 0.0));
    const double from = std::max(y0, -half), to = std::min(y1, half);
    return from < to ? std::array{from, to} : std::array{0.0, 0.0};
  };
  for (std::size_t k = 1; k < kinks.size() && kinks.front() < kinks.back(); ++k) {
    const double a = kinks[k - 1], b = kinks[k];
    part.area += integral([&](double x) { return chord(x)[1] - chord(x)[0]; }, a, b);
    part.moment[0] += integral([&](double x) { return x * (chord(x)[1] - chord(x)[0]); }, a, b);
    part.moment[1] += integral(
        [&](double x) { return 0.5 * (std::pow(chord(x)[1], 2) - std::pow(chord(x)[0], 2)); }, a,
        b);
  }
  return part;
}

// Every way in which a circle of radius 3 meets a cell, by name.
TEST(BoxInBall, KnowsEveryCase) {
  struct Example {
    const char* name;
    Coordinates centre, edges;
  };
  const std::vector<Example> examples{
      {"whole", {1.0, 1.0, 0}, {1, 1, 0}},
      {"none", {3.0, 3.0, 0}, {1, 1, 0}},
      {"one corner in", {2.5, 2.5, 0}, {1.2, 1.2, 0}},
      {"two corners in", {3.0, 0.3, 0}, {1, 1, 0}},
      {"three corners in", {1.8, 1.8, 0}, {1, 1, 0}},
      {"a bulge over one side, no corner in", {3.4, 0.0, 0}, {1, 1, 0}},
      {"cut twice: the far side bulges, its corners are out", {2.48, 0.0, 0}, {1, 1, 0}},
      {"cut twice: two opposite corners out", {2.1, 2.1, 0}, {0.9, 0.1, 0}},
      {"cut by two arcs, on either side of a strip", {0.0, 0.0, 0}, {8, 1, 0}},
      {"cut by four arcs", {0.0, 0.0, 0}, {5.5, 5.5, 0}},
      {"a whole disk", {0.5, 0.2, 0}, {8, 8, 0}},
      {"a half disk", {2.0, 0.0, 0}, {4, 8, 0}},
      {"through two corners", {3.0 * 0.8 - 0.5, 1.8, 0}, {1.0, 3.6, 0}},
      {"touching a side", {3.5, 0.0, 0}, {1, 1, 0}},
  };
  for (const auto& [name, centre, edges] : examples) {
    for (int quarter = 0; quarter < 4; ++quarter) {
      const Coordinates at = quarter == 0   ? centre
                             : quarter == 1 ? Coordinates{-centre[1], centre[0], 0}
                             : quarter == 2 ? Coordinates{-centre[0], -centre[1], 0}
                                            : Coordinates{centre[1], -centre[0], 0};
      const Coordinates size = quarter % 2 == 0 ? edges : Coordinates{edges[1], edges[0], 0};
      const double whole = size[0] * size[1];
      const BoxPart part = box_in_ball(at, size, 3.0, 2);
      const PolygonPart expected = by_chords(at, size, 3.0);
      EXPECT_NEAR(part.share * whole, expected.area, 1e-12) << name;
      for (std::size_t c = 0; c < 2; ++c) {
        EXPECT_NEAR(part.share * whole * part.centroid[c], expected.moment[c], 1e-11) << name;
      }
    }
  }
}

TEST(BoxInBall, KnowsRandomRectangles) {
  tests::Random random(5);
  int cut = 0;
  for (int k = 0; k < 400; ++k) {
    const Coordinates at{3.4 * random.number(), 3.4 * random.number(), 0.0};
    const Coordinates edges{1.0 + 0.8 * random.number(), 1.0 + 0.8 * random.number(), 0.0};
    const BoxPart part = box_in_ball(at, edges, 3.0, 2);
    const PolygonPart expected = by_chords(at, edges, 3.0);
    const double whole = edges[0] * edges[1];
    EXPECT_NEAR(part.share * whole, expected.area, 1e-12);
    if (part.share < 1e-3) continue;
    cut += part.share < 1.0;
    for (std::size_t c = 0; c < 2; ++c) {
      EXPECT_NEAR(part.centroid[c], expected.moment[c] / expected.area, 1e-9);
    }
  }
  EXPECT_GT(cut, 50);
}

// A cap of height h has the volume pi h^2 (3 r - h) / 3 and the moment pi h^2 (2 r - h)^2 / 4 about
// the ball's centre.
TEST(BoxInBall, KnowsCapsOfABall) {
  const double radius = 1.7;
  for (const double height : {0.3, 1.0, 1.7, 2.9}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Coordinates at{}, edges{4.0, 4.0, 4.0};
      at[axis] = radius - height + 2.0;
      const BoxPart part = box_in_ball(at, edges, radius, 3);
      const double volume = pi * height * height * (3.0 * radius - height) / 3.0;
      const double moment = pi * std::pow(height * (2.0 * radius - height), 2) / 4.0;
      EXPECT_NEAR(part.share * 64.0 / volume, 1.0, 1e-13);
      EXPECT_NEAR(part.centroid[axis] * volume / moment, 1.0, 1e-13);
      EXPECT_NEAR(part.centroid[(axis + 1) % 3], 0.0, 1e-14);
    }
  }
}

// A box is its eight parts, which meet the ball in other ways: round-off of the faces' moments.
TEST(BoxInBall, IsTheSumOfItsOctants) {
  tests::Random random(11);
  int cut = 0;
  for (int k = 0; k < 150; ++k) {
    Coordinates at{}, edges{};
    for (std::size_t c = 0; c < 3; ++c) {
      at[c] = 2.0 * random.number();
      edges[c] = 1.0 + 0.7 * random.number();
    }
    const BoxPart whole = box_in_ball(at, edges, 2.0, 3);
    double share = 0.0;
    Coordinates moment{};
    for (const int octant : {0, 1, 2, 3, 4, 5, 6, 7}) {
      Coordinates middle{}, half{};
      for (std::size_t c = 0; c < 3; ++c) {
        half[c] = 0.5 * edges[c];
        middle[c] = at[c] + 0.25 * edges[c] * ((octant >> c & 1) ? 1.0 : -1.0);
      }
      const BoxPart part = box_in_ball(middle, half, 2.0, 3);
      share += part.share / 8.0;
      for (std::size_t c = 0; c < 3; ++c) moment[c] += part.share / 8.0 * part.centroid[c];
    }
    EXPECT_NEAR(whole.share, share, 1e-13);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(whole.share * whole.centroid[c], moment[c], 1e-13);
    }
    cut += whole.share > 0.0 && whole.share < 1.0;
  }
  EXPECT_GT(cut, 40);
}

}  // namespace
}  // namespace peristat
