#include "src/connectivity/crack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::for_each_bond;

/// A bond that passes or misses a crack, and whether it is cut.
struct Position {
  const char* name;
  Coordinates a, b;
  bool cut;
};

constexpr double gap = 1e-7;     // clearly apart: 100 tolerances of a bond of length one
constexpr double touch = 1e-10;  // a tenth of its tolerance

const CrackSegment segment{{0, 0, 0}, {2, 0, 0}};
const std::vector<Position> around_segment{
    {"crosses", {1, -0.5, 0}, {1.2, 0.7, 0}, true},
    {"crosses at right angles", {1, -0.5, 0}, {1, 0.5, 0}, true},
    {"passes the end", {2.1, -0.5, 0}, {2.1, 0.5, 0}, false},
    {"stops short", {1, 0.1, 0}, {1, 1, 0}, false},
    {"ends on the crack", {1, 0, 0}, {1.3, 1, 0}, true},
    {"ends within the tolerance", {1, touch, 0}, {1.3, 1, 0}, true},
    {"ends above the crack", {1, gap, 0}, {1.3, 1, 0}, false},
    {"passes through the end", {2, -0.5, 0}, {2, 0.5, 0}, true},
    {"passes just beyond the end", {2 + gap, -0.5, 0}, {2 + gap, 0.5, 0}, false},
    {"passes through the end obliquely", {1.5, 0.5, 0}, {2.5, -0.5, 0}, true},
    {"passes just beyond the end obliquely", {1.5 + gap, 0.5, 0}, {2.5 + gap, -0.5, 0}, false},
    {"ends meet", {2, 0, 0}, {3, 1, 0}, true},
    {"ends just do not meet", {2 + gap, 0, 0}, {3, 1, 0}, false},
    {"ends meet, folded back", {2, 0, 0}, {1, 1e-3, 0}, true},
    {"in line, ends meet", {2, 0, 0}, {3, 0, 0}, true},
    {"in line, ends within the tolerance", {2 + touch, 0, 0}, {3, 0, 0}, true},
    {"in line, ends just do not meet", {2 + gap, 0, 0}, {3, 0, 0}, false},
    {"in line, before", {-1, 0, 0}, {-0.1, 0, 0}, false},
    {"in line, behind", {2.1, 0, 0}, {3, 0, 0}, false},
    {"in line, overlaps", {1.5, 0, 0}, {2.5, 0, 0}, true},
    {"in line, within", {0.5, 0, 0}, {1.5, 0, 0}, true},
    {"in line, around", {-1, 0, 0}, {3, 0, 0}, true},
    {"the same", {0, 0, 0}, {2, 0, 0}, true},
    {"parallel", {0.5, 0.3, 0}, {1.5, 0.3, 0}, false},
    {"parallel, just above", {0.5, gap, 0}, {1.5, gap, 0}, false},
    {"parallel, within the tolerance", {0.5, touch, 0}, {1.5, touch, 0}, true},
    {"parallel, within the tolerance, behind", {2.1, touch, 0}, {3, touch, 0}, false},
    {"nearly parallel", {0.5, -1e-6, 0}, {1.5, 1e-6, 0}, true},
    {"nearly parallel, crosses the line behind", {1.5, -1e-6, 0}, {3.5, 1e-6, 0}, false},
    {"nearly parallel by round-off", {0.5, -1e-16, 0}, {1.5, 1e-16, 0}, true},
    {"nearly parallel by round-off, behind", {2.5, -1e-16, 0}, {3.5, 1e-16, 0}, false},
};

// An L: a reentrant corner at (1, 1) and a notch beyond it.
const CrackPolygon corner{{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}};
const std::vector<Position> around_corner{
    {"crosses", {0.5, 0.5, -1}, {0.5, 0.5, 1}, true},
    {"crosses obliquely", {-0.5, 0.2, -1}, {1.7, 1.2, 1}, true},
    {"crosses the notch", {1.5, 1.5, -1}, {1.5, 1.5, 1}, false},
    {"passes outside", {2.5, 0.5, -1}, {2.5, 0.5, 1}, false},
    {"is over the crack at one end only", {0.5, 0.5, 1}, {3, 0.5, -0.3}, false},
    {"stops short", {0.5, 0.5, 0.1}, {0.5, 0.5, 1}, false},
    {"stops short below", {0.5, 0.5, -0.1}, {0.5, 0.5, -1}, false},
    {"parallel", {0.2, 0.2, 0.3}, {0.8, 0.4, 0.3}, false},
    // An end in the plane.
    {"ends inside", {0.5, 0.5, 0}, {0.7, 0.5, 1}, true},
    {"ends inside within the tolerance", {0.5, 0.5, touch}, {0.7, 0.5, 1}, true},
    {"ends above", {0.5, 0.5, gap}, {0.7, 0.5, 1}, false},
    {"ends in the notch", {1.5, 1.5, 0}, {1.5, 1.5, 1}, false},
    {"ends in the notch, over the crack", {1.5, 1.5, 0}, {0.5, 0.5, 1}, false},
    {"ends on an edge", {1, 0, 0}, {1, -0.5, 0.5}, true},
    {"ends just off an edge", {1, -gap, 0}, {1, -0.5, 0.5}, false},
    {"ends at a vertex", {2, 0, 0}, {3, -1, 1}, true},
    {"ends just off a vertex", {2 + gap, 0, 0}, {3, -1, 1}, false},
    // Through edges and vertices, and through places at the height of vertices.
    {"through an edge", {1, 0, -0.5}, {1, 0, 0.5}, true},
    {"just off an edge", {1, -gap, -0.5}, {1, -gap, 0.5}, false},
    {"through an edge obliquely", {0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, true},
    {"just off an edge obliquely", {0.5, -0.5 - gap, -0.5}, {0.5, 0.5 - gap, 0.5}, false},
    {"through an edge of the notch", {1.5, 1, -0.5}, {1.5, 1, 0.5}, true},
    {"just off an edge of the notch", {1.5, 1 + gap, -0.5}, {1.5, 1 + gap, 0.5}, false},
    {"through a vertex", {2, 0, -0.5}, {2, 0, 0.5}, true},
    {"just off a vertex", {2 + gap, 0, -0.5}, {2 + gap, 0, 0.5}, false},
    {"through the reentrant vertex", {1, 1, -0.5}, {1, 1, 0.5}, true},
    {"just off the reentrant vertex", {1 + gap, 1 + gap, -0.5}, {1 + gap, 1 + gap, 0.5}, false},
    {"level with vertices, inside", {0.5, 1, -0.5}, {0.5, 1, 0.5}, true},
    {"level with vertices, left", {-0.5, 1, -0.5}, {-0.5, 1, 0.5}, false},
    {"level with vertices, right", {2.5, 1, -0.5}, {2.5, 1, 0.5}, false},
    {"level with the lowest edge", {-0.5, 0, -0.5}, {-0.5, 0, 0.5}, false},
    {"level with the highest edge", {1.5, 2, -0.5}, {1.5, 2, 0.5}, false},
    // In the plane.
    {"coplanar inside", {0.2, 0.2, 0}, {0.8, 0.4, 0}, true},
    {"coplanar inside within the tolerance", {0.1, 0.2, touch}, {0.9, 0.8, touch}, true},
    {"just above the plane", {0.1, 0.2, gap}, {0.9, 0.8, gap}, false},
    {"coplanar from the inside out", {0.5, 0.5, 0}, {-1, 0.5, 0}, true},
    {"coplanar right across", {-1, 0.5, 0}, {3, 0.5, 0}, true},
    {"coplanar from inside over the notch to inside", {1.9, 0.9, 0}, {0.9, 1.9, 0}, true},
    {"coplanar outside", {2.5, 0, 0}, {2.5, 1, 0}, false},
    {"coplanar in the notch", {1.2, 1.8, 0}, {1.8, 1.2, 0}, false},
    {"coplanar in the notch from edge to edge", {1, 1.5, 0}, {1.5, 1, 0}, true},
    {"coplanar in the notch, just off the edges", {1 + gap, 1.5, 0}, {1.5, 1 + gap, 0}, false},
    {"coplanar, ends on an edge", {0.5, 0, 0}, {0.5, -1, 0}, true},
    {"coplanar, ends just off an edge", {0.5, -gap, 0}, {0.5, -1, 0}, false},
    {"coplanar, passes through a vertex", {1.5, 1.5, 0}, {2.5, 0.5, 0}, true},
    {"coplanar, passes just off a vertex", {1.5 + gap, 1.5, 0}, {2.5 + gap, 0.5, 0}, false},
    {"coplanar, ends at a vertex", {2, 0, 0}, {3, -1, 0}, true},
    {"coplanar, ends just off a vertex", {2 + gap, 0, 0}, {3, -1, 0}, false},
    {"along an edge", {0.5, 0, 0}, {1.5, 0, 0}, true},
    {"along just off an edge", {0.5, -gap, 0}, {1.5, -gap, 0}, false},
    {"in line with an edge, overlaps", {1.5, 0, 0}, {2.5, 0, 0}, true},
    {"in line with an edge, behind", {2.1, 0, 0}, {3, 0, 0}, false},
    {"in line with an edge, along the notch", {2.5, 1, 0}, {3.5, 1, 0}, false},
    {"nearly coplanar inside", {0.2, 0.2, -1e-6}, {0.8, 0.4, 1e-6}, true},
    {"nearly coplanar in the notch", {1.2, 1.8, -1e-6}, {1.8, 1.2, 1e-6}, false},
    {"nearly coplanar by round-off inside", {0.2, 0.2, -1e-16}, {0.8, 0.4, 1e-16}, true},
    {"nearly coplanar by round-off in the notch", {1.2, 1.8, -1e-16}, {1.8, 1.2, 1e-16}, false},
};

/// x -> scale (R x + shift)
struct Motion {
  std::array<Coordinates, 3> rotation;
  Coordinates shift;
  double scale;

  Coordinates operator()(const Coordinates& x) const {
    Coordinates result;
    for (int r = 0; r < 3; ++r) {
      const Coordinates& row = rotation[r];
      result[r] = scale * (row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + shift[r]);
    }
    return result;
  }
  CrackSegment operator()(const CrackSegment& crack) const {
    return {(*this)(crack.from), (*this)(crack.to)};
  }
  CrackPolygon operator()(CrackPolygon crack) const {
    for (Coordinates& vertex : crack.vertices) vertex = (*this)(vertex);
    return crack;
  }
};

/// Rotations about z, and in 3D after turns about x that bring every axis near the normal.
std::vector<Motion> motions(int dimension) {
  std::vector<Motion> result;
  for (double z : {0.0, 0.3, M_PI / 4, 2.0, M_PI}) {
    for (double x : {0.0, 0.7, M_PI / 2, 4.0}) {
      if (dimension == 2 && x != 0.0) continue;
      const double c = std::cos(z), s = std::sin(z), k = std::cos(x), t = std::sin(x);
      const std::array<Coordinates, 3> rotation{
          {{c, -s * k, s * t}, {s, c * k, -c * t}, {0, t, k}}};
      for (double scale : {1.0, 1e-6, 1e6}) {
        result.push_back({rotation, {0, 0, 0}, scale});
        result.push_back({rotation, {3, -20, dimension == 2 ? 0.0 : 7.0}, scale});
      }
    }
  }
  return result;
}

TEST(Crack, CutsWhatMeetsASegment) {
  const CrackSegment reversed{segment.to, segment.from};
  for (const Motion& motion : motions(2)) {
    for (const Position& p : around_segment) {
      const Coordinates a = motion(p.a), b = motion(p.b);
      EXPECT_EQ(cuts(motion(segment), a, b), p.cut) << p.name << " " << motion.scale;
      EXPECT_EQ(cuts(motion(segment), b, a), p.cut) << p.name << " " << motion.scale;
      EXPECT_EQ(cuts(motion(reversed), a, b), p.cut) << p.name << " " << motion.scale;
    }
  }
}

TEST(Crack, CutsWhatMeetsAPolygon) {
  CrackPolygon reversed = corner, shifted = corner;
  std::reverse(reversed.vertices.begin(), reversed.vertices.end());
  std::rotate(shifted.vertices.begin(), shifted.vertices.begin() + 3, shifted.vertices.end());
  for (const Motion& motion : motions(3)) {
    EXPECT_NO_THROW(check_crack(motion(corner), 3, "crack"));
    for (const Position& p : around_corner) {
      const Coordinates a = motion(p.a), b = motion(p.b);
      EXPECT_EQ(cuts(motion(corner), a, b), p.cut) << p.name << " " << motion.scale;
      EXPECT_EQ(cuts(motion(corner), b, a), p.cut) << p.name << " " << motion.scale;
      EXPECT_EQ(cuts(motion(reversed), a, b), p.cut) << p.name << " " << motion.scale;
      EXPECT_EQ(cuts(motion(shifted), a, b), p.cut) << p.name << " " << motion.scale;
    }
  }
}

// ---- all segments on small grids, against integers ----

using Place = std::array<int, 3>;

int orientation(const Place& a, const Place& b, const Place& c) {
  const int twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  return (twice > 0) - (twice < 0);
}

bool in_box(const Place& at, const Place& a, const Place& b) {
  for (int c = 0; c < 2; ++c) {
    if (at[c] < std::min(a[c], b[c]) || at[c] > std::max(a[c], b[c])) return false;
  }
  return true;
}

bool segments_meet(const Place& a, const Place& b, const Place& p, const Place& q) {
  const int pa = orientation(p, q, a), pb = orientation(p, q, b);
  const int ap = orientation(a, b, p), aq = orientation(a, b, q);
  return (pa != pb && ap != aq) || (pa == 0 && in_box(a, p, q)) || (pb == 0 && in_box(b, p, q)) ||
         (ap == 0 && in_box(p, a, b)) || (aq == 0 && in_box(q, a, b));
}

bool meets_rectangle(const Place& a, const Place& b, const Place& low, const Place& high) {
  const Place corners[] = {low, {high[0], low[1]}, high, {low[0], high[1]}};
  if (in_box(a, low, high)) return true;
  for (int k = 0; k < 4; ++k) {
    if (segments_meet(a, b, corners[k], corners[(k + 1) % 4])) return true;
  }
  return false;
}

/// Twice the size of `corner`, which is made of two rectangles.
bool meets_double_corner(const Place& a, const Place& b) {
  return meets_rectangle(a, b, {0, 0}, {4, 2}) || meets_rectangle(a, b, {0, 0}, {2, 4});
}

Coordinates scaled(const Place& place, double factor) {
  return {factor * place[0], factor * place[1], factor * place[2]};
}

TEST(Crack, CutsAllSegmentsOfAGridLikeIntegersDo) {
  std::vector<Place> grid;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 4; ++y) grid.push_back({x, y});
  }
  int met = 0, all = 0;
  for (const Motion& motion : motions(2)) {
    if (motion.scale != 1.0) continue;
    for (const Place& p : grid) {
      for (const Place& q : grid) {
        if (p == q) continue;
        const CrackSegment crack = motion(CrackSegment{scaled(p, 0.1), scaled(q, 0.1)});
        for (const Place& a : grid) {
          for (const Place& b : grid) {
            if (a == b) continue;
            const bool expected = segments_meet(a, b, p, q);
            ++all;
            met += expected;
            if (cuts(crack, motion(scaled(a, 0.1)), motion(scaled(b, 0.1))) == expected) continue;
            FAIL() << a[0] << a[1] << " " << b[0] << b[1] << " " << p[0] << p[1] << " " << q[0]
                   << q[1];
          }
        }
      }
    }
  }
  EXPECT_GT(met, all / 10);
  EXPECT_LT(met, all / 2);
}

TEST(Crack, CutsAllBondsOfAGridLikeIntegersDo) {
  std::vector<Place> grid;  // in halves, one layer below, in and above the plane of the crack
  for (int z = -1; z <= 1; ++z) {
    for (int x = -1; x <= 5; ++x) {
      for (int y = -1; y <= 5; ++y) grid.push_back({x, y, z});
    }
  }
  int met = 0, all = 0;
  for (const Motion& motion : motions(3)) {
    if (motion.scale != 1.0) continue;
    const CrackPolygon crack = motion(corner);
    for (const Place& a : grid) {
      for (const Place& b : grid) {
        if (a == b) continue;
        bool expected = false;
        if (a[2] == 0 && b[2] == 0) {
          expected = meets_double_corner(a, b);
        } else if (a[2] * b[2] <= 0) {
          // The place in the plane, in quarters to be an integer: that of an end or the middle.
          const Place low = a[2] == 0 ? a : b[2] == 0 ? b : Place{};
          Place at{2 * low[0], 2 * low[1]};
          if (a[2] != 0 && b[2] != 0) at = {a[0] + b[0], a[1] + b[1]};
          expected = in_box(at, {0, 0}, {8, 4}) || in_box(at, {0, 0}, {4, 8});
        }
        ++all;
        met += expected;
        if (cuts(crack, motion(scaled(a, 0.5)), motion(scaled(b, 0.5))) == expected) continue;
        FAIL() << a[0] << " " << a[1] << " " << a[2] << ", " << b[0] << " " << b[1] << " " << b[2];
      }
    }
  }
  EXPECT_GT(met, all / 10);
  EXPECT_LT(met, all / 2);
}

TEST(Crack, TouchesRelativeToTheBondsLength) {
  for (double length : {1e-3, 1.0, 1e3}) {
    const double inside = 0.5 * touching_tolerance * length;
    const double outside = 2.0 * touching_tolerance * length;
    EXPECT_TRUE(cuts(segment, {1, inside, 0}, {1, inside + length, 0}));
    EXPECT_FALSE(cuts(segment, {1, outside, 0}, {1, outside + length, 0}));
    EXPECT_TRUE(cuts(corner, {0.5, 0.5, inside}, {0.5, 0.5, inside + length}));
    EXPECT_FALSE(cuts(corner, {0.5, 0.5, outside}, {0.5, 0.5, outside + length}));
    EXPECT_TRUE(cuts(corner, {-inside, 0.5, -length}, {-inside, 0.5, length}));
    EXPECT_FALSE(cuts(corner, {-2 * outside, 0.5, -length}, {-2 * outside, 0.5, length}));
  }
}

TEST(Crack, EndsExactlyHoweverLongItIs) {
  for (double far : {1e3, 1e9, 1e30}) {
    const CrackSegment crack{{-far, 0.25, 0}, {0.5, 0.25, 0}};
    EXPECT_TRUE(cuts(crack, {0.5, 0.2, 0}, {0.5, 0.3, 0}));
    EXPECT_TRUE(cuts(crack, {0.4, 0.2, 0}, {0.4, 0.3, 0}));
    EXPECT_TRUE(cuts(crack, {0.4, 0.2, 0}, {0.45, 0.3, 0}));
    EXPECT_TRUE(cuts(crack, {0.4, 0.25, 0}, {0.45, 0.25, 0}));
    EXPECT_FALSE(cuts(crack, {0.5 + gap, 0.2, 0}, {0.5 + gap, 0.3, 0}));
    EXPECT_FALSE(cuts(crack, {0.45, 0.2, 0}, {0.6, 0.3, 0}));
    EXPECT_FALSE(cuts(crack, {0.4, 0.25 + gap, 0}, {0.4, 0.3, 0}));
    EXPECT_FALSE(cuts(crack, {0.4, 0.25 + gap, 0}, {0.45, 0.25 + gap, 0}));
  }
}

// ---- refusals ----

std::string refused_key(const Crack& crack, int dimension) {
  try {
    check_crack(crack, dimension, "crack[2]");
  } catch (const InputError& error) {
    return error.key();
  }
  return "nothing";
}

TEST(CheckCrack, AcceptsWhatFitsTheDimension) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    EXPECT_EQ(refused_key(segment, dimension), dimension == 2 ? "nothing" : "crack[2].to");
    EXPECT_EQ(refused_key(corner, dimension), dimension == 3 ? "nothing" : "crack[2].vertices");
  }
  EXPECT_EQ(refused_key(CrackPolygon{{{0, 0, 1}, {1, 0, 2}, {0, 1, 3}}}, 3), "nothing");
}

TEST(CheckCrack, RefusesSegmentsWithoutLength) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refused_key(CrackSegment{{1, 2, 0}, {1, 2, 0}}, 2), "crack[2].to");
  EXPECT_EQ(refused_key(CrackSegment{{1, 2, 0}, {1, 2.001, 0}}, 2), "nothing");
  EXPECT_EQ(refused_key(CrackSegment{{nan, 2, 0}, {1, 2, 0}}, 2), "crack[2].from");
  EXPECT_EQ(refused_key(CrackSegment{{1, 2, 0}, {1, infinity, 0}}, 2), "crack[2].to");
}

void expect_refused(std::vector<Coordinates> vertices, const std::string& why) {
  for (double scale : {1.0, 1e-6, 1e6}) {
    CrackPolygon crack;
    for (const auto& [x, y, z] : vertices)
      crack.vertices.push_back({scale * x, scale * y, scale * z});
    try {
      check_crack(crack, 3, "crack[2]");
      ADD_FAILURE() << "accepted: " << why;
    } catch (const InputError& error) {
      EXPECT_EQ(error.key(), "crack[2].vertices");
      EXPECT_NE(error.allowed().find(why), std::string::npos) << error.what();
    }
  }
}

TEST(CheckCrack, RefusesPolygonsThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused({}, "three vertices");
  expect_refused({{0, 0, 0}, {1, 0, 0}}, "three vertices");
  expect_refused({{0, 0, 0}, {1, 0, 0}, {1, nan, 0}}, "finite");
  expect_refused({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, "area");
  expect_refused({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}, "area");
  expect_refused({{0.1, 0.7, 0}, {0.2, 1.4, 0}, {0.3, 2.1, 0}, {0.7, 4.9, 0}}, "area");
  expect_refused({{0, 0, 0}, {1, 0, 0}, {1, 1, 1e-6}, {0, 1, 0}}, "plane");
  expect_refused({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 1}}, "plane");
}

TEST(CheckCrack, RefusesPolygonsThatMeetThemselves) {
  expect_refused({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}, "area");  // two halves cancel
  expect_refused({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 1, 0}}, "cross");
  // A vertex on an edge, on a vertex, given twice, closed by hand, and a spike out and in.
  expect_refused({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0, 0}, {0, 2, 0}}, "touch");
  expect_refused({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}}, "touch");
  expect_refused({{0, 0, 0}, {2, 0, 0}, {2, 0, 0}, {0, 2, 0}}, "twice");
  expect_refused({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 0}}, "twice");
  expect_refused({{0, 0, 0}, {3, 0, 0}, {2, 0, 0}, {2, 2, 0}}, "touch");
  expect_refused({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}}, "touch");
  // Just not touching.
  EXPECT_EQ(refused_key(CrackPolygon{{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, gap, 0}, {0, 2, 0}}}, 3),
            "nothing");
  // A vertex in the middle of a straight side is none of these.
  EXPECT_EQ(refused_key(CrackPolygon{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}}}, 3), "nothing");
}

// ---- cut_bonds ----

struct Kept {
  Index i, j;
  double inverse_length, weight;
  bool operator==(const Kept&) const = default;
};

/// Cuts the body's bonds and compares with a sign test: is_cut(a, b) of two places.
template <class IsCut>
Offset expect_cut(const BoxBody& body, const std::vector<Crack>& cracks, const IsCut& is_cut) {
  const Bonds& before = body.model.bonds();
  std::vector<Kept> expected, found;
  std::vector<BondEnds> expected_ends;
  std::vector<double> expected_removed(body.points.volume.size(), 0.0);
  for_each_bond(before, [&](Index i, Index j, Offset bond) {
    if (is_cut(body.points.position(i), body.points.position(j))) {
      expected_removed[i] += before.weight(bond);
      expected_removed[j] += before.weight(bond);
      expected_ends.push_back({i, j});
    } else {
      expected.push_back({i, j, before.inverse_length(bond), before.weight(bond)});
    }
  });
  Bonds after = before;
  const auto [removed, removed_ends] = cut_bonds(after, body.points, cracks);
  for_each_bond(after, [&](Index i, Index j, Offset bond) {
    found.push_back({i, j, after.inverse_length(bond), after.weight(bond)});
  });
  EXPECT_EQ(after.points(), before.points());
  EXPECT_EQ(after.offset.back(), after.count());
  EXPECT_EQ(after.kind.size(), std::size_t(after.count()));
  EXPECT_EQ(found, expected);
  EXPECT_EQ(removed, cracks.empty() ? std::vector<double>() : expected_removed);
  EXPECT_EQ(removed_ends, expected_ends);
  const auto weight_of = [](const Bonds& bonds) {
    double sum = 0.0;
    for (const BondKind& kind : tests::kinds(bonds)) sum += kind.weight;
    return sum;
  };
  EXPECT_NEAR(std::accumulate(removed.begin(), removed.end(), 0.0),
              2.0 * (weight_of(before) - weight_of(after)), 1e-13 * weight_of(before));
  return before.count() - after.count();
}

/// Which side of the line from p to q.
bool left_of(const Coordinates& p, const Coordinates& q, const Coordinates& at) {
  return (q[0] - p[0]) * (at[1] - p[1]) > (q[1] - p[1]) * (at[0] - p[0]);
}

TEST(CutBonds, RemovesExactlyThoseAcrossALine) {
  tests::BoxSetting box = tests::small_box(2);
  box.horizon_ratio = 3.015;
  for (double perturbation : {0.0, 0.3}) {
    box.perturbation = perturbation;
    const BoxBody body(box);
    const Coordinates p{-1.0, -0.21, 0}, q{2.0, 0.83, 0};
    const auto across = [&](const Coordinates& a, const Coordinates& b) {
      return left_of(p, q, a) != left_of(p, q, b);
    };
    EXPECT_GT(expect_cut(body, {CrackSegment{p, q}}, across), 50);
    EXPECT_EQ(expect_cut(body, {CrackSegment{p, {-0.1, 0.102, 0}}},
                         [](const Coordinates&, const Coordinates&) { return false; }),
              0);
  }
}

TEST(CutBonds, RemovesThoseAcrossAnyOfManyCracksOnce) {
  tests::BoxSetting box = tests::small_box(2);
  box.perturbation = 0.3;
  const BoxBody body(box);
  // They cross each other, and both end inside the body.
  const std::vector<CrackSegment> segments{{{0.21, 0.13, 0}, {0.72, 0.48, 0}},
                                           {{0.63, 0.17, 0}, {0.31, 0.61, 0}}};
  const auto across = [&](const Coordinates& a, const Coordinates& b) {
    return std::any_of(segments.begin(), segments.end(), [&](const CrackSegment& s) {
      return left_of(s.from, s.to, a) != left_of(s.from, s.to, b) &&
             left_of(a, b, s.from) != left_of(a, b, s.to);
    });
  };
  EXPECT_GT(expect_cut(body, {segments[0], segments[1]}, across), 20);
}

// A notched outline, which a bond may cross twice.
TEST(CutBonds, RemovesExactlyThoseAcrossAnOutline) {
  tests::BoxSetting box = tests::small_box(2);
  box.horizon_ratio = 3.015;
  box.perturbation = 0.3;
  const BoxBody body(box);
  const CrackOutline outline{
      {{0.21, 0.13}, {0.72, 0.11}, {0.68, 0.53}, {0.47, 0.31}, {0.25, 0.58}}};
  const auto across = [&](const Coordinates& a, const Coordinates& b) {
    bool crosses = false;
    for (std::size_t k = 0; k < outline.vertices.size(); ++k) {
      const auto& from = outline.vertices[k];
      const auto& to = outline.vertices[(k + 1) % outline.vertices.size()];
      const Coordinates p{from[0], from[1], 0}, q{to[0], to[1], 0};
      crosses =
          crosses || (left_of(p, q, a) != left_of(p, q, b) && left_of(a, b, p) != left_of(a, b, q));
    }
    return crosses;
  };
  EXPECT_GT(expect_cut(body, {outline}, across), 50);
}

TEST(CutBonds, AShapeCutsWhatCrossesIt) {
  const CrackShape slit{Box{{0, -0.1, 0}, {2, 0.1, 0}}, 2};
  EXPECT_TRUE(cuts(slit, {1, -1, 0}, {1.2, 1, 0}));
  EXPECT_TRUE(cuts(slit, {-0.5, 0, 0}, {2.5, 0, 0}));       // along it
  EXPECT_TRUE(cuts(slit, {1.9, -0.2, 0}, {2.15, 0.3, 0}));  // over a corner
  EXPECT_FALSE(cuts(slit, {2.1, -1, 0}, {2.1, 1, 0}));
  EXPECT_FALSE(cuts(slit, {1, 0.2, 0}, {1.5, 1, 0}));
  const CrackShape hole{Sphere{{0, 0, 0}, 1.0}, 3};
  EXPECT_TRUE(cuts(hole, {-2, 0.5, 0.5}, {2, 0.5, 0.5}));
  EXPECT_FALSE(cuts(hole, {-2, 0.8, 0.8}, {2, 0.8, 0.8}));
  CrackShape mirrored{Disk{{1, 0, 0}, 0.5}, 2};
  mirrored.image.mirror[0] = -1.0;
  EXPECT_TRUE(cuts(mirrored, {-1, -1, 0}, {-1, 1, 0}));
  EXPECT_FALSE(cuts(mirrored, {1, -1, 0}, {1, 1, 0}));
}

TEST(CutBonds, AreCountedForEachCrackThatMeetsThem) {
  const BoxBody body(tests::small_box(2));
  Bonds bonds = body.model.bonds();
  const double at = body.points.position(0)[1] + 0.01;  // between two rows of points
  const std::vector<Crack> cracks{CrackSegment{{-1, at, 0}, {2, at, 0}},
                                  CrackSegment{{-1, at, 0}, {0.5, at, 0}},
                                  CrackSegment{{20, 5, 0}, {30, 5, 0}}};
  const CutBonds cut = cut_bonds(bonds, body.points, cracks);
  const std::vector<std::int64_t> met = bonds_met_by_each(cracks, cut.ends, body.points);
  EXPECT_EQ(met[0], std::int64_t(cut.ends.size()));
  EXPECT_GT(met[1], 0);
  EXPECT_LT(met[1], met[0]);
  EXPECT_EQ(met[2], 0);
}

TEST(CheckCrack, RefusesOutlinesThatAreNone) {
  const CrackOutline square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  EXPECT_EQ(refused_key(square, 2), "nothing");
  EXPECT_EQ(refused_key(square, 3), "crack[2].outline");
  EXPECT_EQ(refused_key(CrackOutline{{{0, 0}, {1, 0}}}, 2), "crack[2].outline");
  EXPECT_EQ(refused_key(CrackOutline{{{0, 0}, {1, 0}, {1, 0}}}, 2), "crack[2].outline");
  EXPECT_EQ(refused_key(CrackOutline{{{0, 0}, {1, 0}, {0, 0}}}, 2), "crack[2].outline");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refused_key(CrackOutline{{{0, 0}, {1, nan}, {0, 1}}}, 2), "crack[2].outline");
}

TEST(CutBonds, RemovesExactlyThoseAcrossAPlane) {
  for (double perturbation : {0.0, 0.3}) {
    tests::BoxSetting box = tests::small_box(3);
    box.perturbation = perturbation;
    const BoxBody body(box);
    // The plane z = 0.11 + 0.2 x + 0.3 y, wider than the body.
    const auto height = [](double x, double y) { return 0.11 + 0.2 * x + 0.3 * y; };
    CrackPolygon crack;
    for (const auto& [x, y] : {std::array{-1.0, -1.0}, {2.0, -1.0}, {2.0, 2.0}, {-1.0, 2.0}}) {
      crack.vertices.push_back({x, y, height(x, y)});
    }
    check_crack(crack, 3, "crack");
    const auto above = [&](const Coordinates& at) { return at[2] > height(at[0], at[1]); };
    EXPECT_GT(expect_cut(
                  body, {crack},
                  [&](const Coordinates& a, const Coordinates& b) { return above(a) != above(b); }),
              100);
  }
}

TEST(CutBonds, OfAPointOnTheCrackAreAllRemoved) {
  const BoxBody body(tests::small_box(2));
  const auto is_on = [](const Coordinates& at) {
    return std::abs(at[0] - 0.45) < 1e-9 && at[1] < 0.4;
  };
  const auto meets = [&](const Coordinates& a, const Coordinates& b) {
    const bool crosses = (a[0] < 0.45) != (b[0] < 0.45);
    const double y = a[1] + (0.45 - a[0]) / (b[0] - a[0]) * (b[1] - a[1]);
    return is_on(a) || is_on(b) || (crosses && y < 0.35 + 1e-9);
  };
  EXPECT_GT(expect_cut(body, {CrackSegment{{0.45, 0.35, 0}, {0.45, -1, 0}}}, meets), 20);
}

TEST(CutBonds, WithoutACrackLeavesAll) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const BoxBody body(tests::small_box(dimension));
    EXPECT_EQ(expect_cut(body, {}, [](const Coordinates&, const Coordinates&) { return false; }),
              0);
  }
}

TEST(CutBonds, MayLeaveNone) {
  tests::BoxSetting box = tests::small_box(2);
  box.extent = {2, 3, 0};
  box.horizon_ratio = 1.015;
  const BoxBody body(box);
  const CrackSegment upright{{0.1, -1, 0}, {0.1, 1, 0}};
  const CrackSegment low{{-1, 0.1, 0}, {1, 0.1, 0}}, high{{-1, 0.2, 0}, {1, 0.2, 0}};
  EXPECT_EQ(expect_cut(body, {upright, low, high},
                       [](const Coordinates&, const Coordinates&) { return true; }),
            7);
}

}  // namespace
}  // namespace peristat
