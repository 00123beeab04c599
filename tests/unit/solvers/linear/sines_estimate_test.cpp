#include "solvers/linear/sines_estimate.hpp"

#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "src/geometry/lattice.hpp"

namespace peristat {
namespace {

using Place = std::array<Index, 3>;

struct Body {
  int dimension = 2;
  Coordinates extent{30.0, 30.0, 0.0};
  std::vector<ShapeStep> changes{};
  std::function<bool(const Place&, int)> held = [](const Place& at, int) { return at[0] < 3; };
};

bool suits(const Body& body) {
  Lattice lattice;
  lattice.dimension = body.dimension;
  lattice.spacing = 1.0;
  lattice.shapes = {{ShapeStep::Action::add, Box{{}, body.extent}}};
  lattice.shapes.insert(lattice.shapes.end(), body.changes.begin(), body.changes.end());
  std::string why_not;
  const LatticeBox box = lattice_box(make_points(lattice), why_not).value();
  std::vector<char> prescribed;
  for (const Index place : box.place) {
    for (int c = 0; c < body.dimension; ++c) prescribed.push_back(body.held(box.numbers(place), c));
  }
  return suits_sines(box, prescribed);
}

ShapeStep without(const Shape& shape) { return {ShapeStep::Action::subtract, shape}; }

TEST(SuitsSines, WholeCompactBodies) {
  EXPECT_TRUE(suits({}));
  EXPECT_TRUE(suits({.extent = {120.0, 30.0, 0.0}}));
  EXPECT_FALSE(suits({.extent = {123.0, 30.0, 0.0}}));
  EXPECT_TRUE(suits({.dimension = 3, .extent = {20.0, 10.0, 10.0}}));
  EXPECT_FALSE(suits({.dimension = 3, .extent = {10.0, 10.0, 4.0}}));
  EXPECT_TRUE(suits({.dimension = 1, .extent = {500.0, 0.0, 0.0}}));
}

TEST(SuitsSines, HolesButNoSlotsAndNoEmptyBoxes) {
  EXPECT_TRUE(suits({.changes = {without(Disk{{15.0, 15.0}, 3.5})}}));
  EXPECT_FALSE(suits({.changes = {without(Disk{{15.0, 15.0}, 7.0})}}));
  // A slot half through: it interrupts half of the rows along x.
  EXPECT_FALSE(suits({.changes = {without(Box{{14.0, -1.0}, {15.0, 15.0}})}}));
  // An L.
  EXPECT_FALSE(suits({.changes = {without(Box{{14.0, 14.0}, {31.0, 31.0}})}}));
}

TEST(SuitsSines, SupportsOfWholeSides) {
  // Each component on a side of its own.
  EXPECT_TRUE(suits({.held = [](const Place& at, int c) { return at[c] < 3; }}));
  // One of them nowhere.
  EXPECT_FALSE(suits({.held = [](const Place& at, int c) { return c == 0 && at[0] < 3; }}));
  EXPECT_FALSE(suits({.held = [](const Place&, int) { return false; }}));
  // A part of a side, or a point inside beside it.
  EXPECT_FALSE(suits({.held = [](const Place& at, int) { return at[0] < 3 && at[1] < 20; }}));
  EXPECT_FALSE(suits(
      {.held = [](const Place& at, int) { return at[0] < 3 || (at[0] == 20 && at[1] == 20); }}));
  // Nothing is solved for.
  EXPECT_TRUE(suits({.held = [](const Place&, int) { return true; }}));
}

}  // namespace
}  // namespace peristat
