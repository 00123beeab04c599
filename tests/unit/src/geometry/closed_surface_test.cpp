#include "src/geometry/closed_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/coordinates.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

using Triangle = ClosedSurface::Triangle;

struct Surface {
  std::vector<Coordinates> vertices;
  std::vector<Triangle> triangles;
};

/// The unit cube's two triangles per side, every second one turned round.
Surface cube(double size = 1.0, double from = 0.0) {
  Surface of;
  for (int k = 0; k < 8; ++k)
    of.vertices.push_back(
        {from + size * (k & 1), from + size * (k >> 1 & 1), from + size * (k >> 2)});
  const std::array<std::array<std::size_t, 4>, 6> sides{
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  for (const auto& [a, b, c, d] : sides) {
    of.triangles.push_back({a, b, c});
    of.triangles.push_back({a, c, d});
  }
  return of;
}

/// An icosphere of radius 1: octahedron's triangles quartered.
Surface sphere(int quarterings) {
  Surface of{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}, {}};
  for (const std::size_t x : {0, 1})
    for (const std::size_t y : {2, 3})
      for (const std::size_t z : {4, 5}) of.triangles.push_back({x, y, z});
  for (int k = 0; k < quarterings; ++k) {
    std::map<std::array<std::size_t, 2>, std::size_t> middles;
    const auto middle = [&](std::size_t a, std::size_t b) {
      const auto [at, is_new] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, of.vertices.size());
      if (is_new) of.vertices.push_back(unit(plus(of.vertices[a], of.vertices[b])));
      return at->second;
    };
    std::vector<Triangle> parts;
    for (const auto& [a, b, c] : of.triangles) {
      const std::size_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      parts.insert(parts.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    of.triangles = parts;
  }
  return of;
}

std::string refusal(const Surface& of) {
  try {
    const ClosedSurface surface(of.vertices, of.triangles);
  } catch (const InputError& error) {
    return error.allowed();
  }
  return "nothing";
}

TEST(ClosedSurface, ContainsItsInsideAndItsBoundaryOnly) {
  const Surface of = cube();
  const ClosedSurface surface(of.vertices, of.triangles);
  // Rays from these places meet edges and vertices.
  for (const double x : {0.0, 1e-3, 0.5, 1.0})
    for (const double y : {0.0, 0.5, 1.0})
      for (const double z : {0.0, 0.25, 0.5, 1.0}) EXPECT_TRUE(surface.contains({x, y, z}));
  for (const double out : {-1.0, -1e-6, 1 + 1e-6, 3.0}) {
    EXPECT_FALSE(surface.contains({out, 0.5, 0.5}));
    EXPECT_FALSE(surface.contains({0.0, out, 0.0}));
    EXPECT_FALSE(surface.contains({1.0, 0.5, out}));
  }
  EXPECT_TRUE(surface.contains({1 + 1e-10, 0.5, 0.5}));
  EXPECT_EQ(surface.bounds().max, (Coordinates{1, 1, 1}));
}

TEST(ClosedSurface, OfASphereIsItsPolyhedron) {
  const Surface of = sphere(4);
  const ClosedSurface surface(of.vertices, of.triangles);
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-1.1, 1.1);
  int inside = 0;
  constexpr int samples = 20000;
  for (int k = 0; k < samples; ++k) {
    const Coordinates at{uniform(generator), uniform(generator), uniform(generator)};
    const double r = length(at);
    // Edges of 2^-4 quarter turns: facets are up to 1 - cos(0.06) = 2e-3 below the sphere.
    if (r < 0.995) {
      EXPECT_TRUE(surface.contains(at));
    }
    if (r > 1.0) {
      EXPECT_FALSE(surface.contains(at));
    }
    EXPECT_NEAR(surface.distance(at), std::abs(1 - r), 5e-3);
    inside += surface.contains(at);
    if (r > 0.99) continue;
    std::vector<double> t;
    surface.append_crossings({at, {0.1, 0.7, -0.2}}, t);
    std::sort(t.begin(), t.end());
    ASSERT_GE(t.size(), 2u);
    EXPECT_LT(t.front(), 0.0);
    EXPECT_GT(t.back(), 0.0);
    EXPECT_NEAR(length(Line{at, {0.1, 0.7, -0.2}}.at(t.back())), 1.0, 5e-3);
  }
  // 3 deviations of a binomial distribution.
  EXPECT_NEAR(double(inside) / samples, 4.18879 / std::pow(2.2, 3), 0.011);
}

TEST(ClosedSurface, OfAShellInAShellHasACavity) {
  Surface of = cube();
  const Surface inner = cube(0.5, 0.25);
  for (const auto& [a, b, c] : inner.triangles) of.triangles.push_back({a + 8, b + 8, c + 8});
  of.vertices.insert(of.vertices.end(), inner.vertices.begin(), inner.vertices.end());
  const ClosedSurface surface(of.vertices, of.triangles);
  EXPECT_TRUE(surface.contains({0.1, 0.1, 0.1}));
  EXPECT_FALSE(surface.contains({0.5, 0.5, 0.5}));
  EXPECT_NEAR(surface.distance({0.5, 0.5, 0.5}), 0.25, 1e-14);
}

TEST(ClosedSurface, LeavesOutTrianglesWithoutArea) {
  Surface of = cube();
  of.triangles.push_back({0, 0, 1});
  // A needle between the halves of an edge that one side has whole.
  of.vertices.push_back({0.5, 0, 0});
  const auto first = std::find(of.triangles.begin(), of.triangles.end(), Triangle{0, 1, 3});
  ASSERT_NE(first, of.triangles.end());
  *first = {0, 8, 3};
  of.triangles.push_back({8, 1, 3});
  of.triangles.push_back({0, 8, 1});
  const ClosedSurface surface(of.vertices, of.triangles);
  EXPECT_TRUE(surface.contains({0.5, 1e-4, 0.5}));
  EXPECT_FALSE(surface.contains({0.5, -1e-4, 0.5}));
}

TEST(ClosedSurface, IsRefusedIfItHasNoInside) {
  Surface open = cube();
  open.triangles.pop_back();
  EXPECT_NE(refusal(open).find("3 edges do not belong to two triangles"), std::string::npos)
      << refusal(open);
  Surface twice = cube();
  twice.triangles.push_back(twice.triangles.front());
  EXPECT_NE(refusal(twice).find("3 edges do not"), std::string::npos) << refusal(twice);
  Surface crossing = cube();
  const Surface other = cube(1.0, 0.5);
  for (const auto& [a, b, c] : other.triangles) crossing.triangles.push_back({a + 8, b + 8, c + 8});
  crossing.vertices.insert(crossing.vertices.end(), other.vertices.begin(), other.vertices.end());
  EXPECT_NE(refusal(crossing).find("crosses or touches itself"), std::string::npos);
  EXPECT_NE(refusal({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}, {0, 1, 2}}}).find("no inside"),
            std::string::npos);
  Surface infinite = cube();
  infinite.vertices[0][1] = INFINITY;
  EXPECT_NE(refusal(infinite).find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace peristat
