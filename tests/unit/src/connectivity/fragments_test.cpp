#include "src/connectivity/fragments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <span>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "src/neighbourhood/search.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using Place = std::array<double, 3>;

/// Points at given places, bonded by name or by distance, with flags of broken bonds.
struct Web {
  Points points;
  Bonds bonds;
  std::vector<char> broken, prescribed;
  std::vector<double> displacement;

  explicit Web(int dimension) {
    points.dimension = dimension;
    points.spacing = 1.0;
  }

  Web& add(std::initializer_list<Place> places) {
    for (const Place& at : places) {
      points.reference.insert(points.reference.end(), at.begin(), at.begin() + points.dimension);
      points.volume.push_back(1.0);
    }
    return *this;
  }

  /// Points of unit spacing in a box.
  Web& add_block(std::array<int, 3> extent, const Place& corner = {}) {
    for (int x = 0; x < extent[0]; ++x) {
      for (int y = 0; y < extent[1]; ++y) {
        for (int z = 0; z < extent[2]; ++z) {
          add({{corner[0] + x, corner[1] + y, corner[2] + z}});
        }
      }
    }
    return *this;
  }

  /// Bonds between all points within a distance; its default reaches the diagonals.
  Web& bond(double horizon = 1.8) {
    bonds = search_bonds(points, horizon, 1);
    broken.assign(std::size_t(bonds.count()), 0);
    prescribed.assign(points.reference.size(), 0);
    displacement.assign(points.reference.size(), 0.0);
    return *this;
  }

  Web& hold(Index point, int component) {
    prescribed[std::size_t(point) * points.dimension + component] = 1;
    return *this;
  }

  Web& hold(std::initializer_list<Index> whole) {
    for (Index point : whole) {
      for (int c = 0; c < points.dimension; ++c) hold(point, c);
    }
    return *this;
  }

  /// Breaks the bonds with drop(a, b), a and b the reference positions of their points.
  template <class Drop>
  Web& break_if(const Drop& drop) {
    tests::for_each_bond(bonds, [&](Index i, Index j, Offset bond) {
      if (drop(points.position(i), points.position(j))) broken[bond] = 1;
    });
    return *this;
  }

  /// Breaks the bonds across the line or plane x = at.
  Web& cut(double at) {
    return break_if(
        [&](const Coordinates& a, const Coordinates& b) { return (a[0] < at) != (b[0] < at); });
  }

  /// Breaks all bonds of a point but those to the given partners.
  Web& leave(Index point, const std::vector<Index>& partners) {
    tests::for_each_bond(bonds, [&](Index i, Index j, Offset bond) {
      if (i != point && j != point) return;
      const Index other = i == point ? j : i;
      if (std::find(partners.begin(), partners.end(), other) == partners.end()) broken[bond] = 1;
    });
    return *this;
  }

  /// Displaces to x -> R x, R a rotation about z (and, in 3D, the same about x).
  Web& rotate(double angle) {
    Eigen::Matrix3d rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).matrix();
    if (points.dimension == 3) {
      rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()).matrix() * rotation;
    }
    for (Index i = 0; i < points.count(); ++i) {
      const Coordinates at = points.position(i);
      const Eigen::Vector3d from(at[0], at[1], at[2]);
      const Eigen::Vector3d to = rotation * from;
      for (int c = 0; c < points.dimension; ++c) {
        displacement[std::size_t(i) * points.dimension + c] = to(c) - from(c);
      }
    }
    return *this;
  }

  [[nodiscard]] Fragments find() const {
    return find_fragments(points, bonds, broken, prescribed, displacement, {prescribed});
  }

  /// Stiffness of unit springs along the unbroken bonds, in the present state.
  [[nodiscard]] Eigen::MatrixXd stiffness() const {
    const int d = points.dimension;
    const auto size = static_cast<Eigen::Index>(points.reference.size());
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
    tests::for_each_bond(bonds, [&](Index i, Index j, Offset bond) {
      if (broken[bond]) return;
      Eigen::VectorXd arm(d);
      for (int c = 0; c < d; ++c) {
        const std::size_t to = std::size_t(j) * d + c, from = std::size_t(i) * d + c;
        arm(c) =
            points.reference[to] + displacement[to] - points.reference[from] - displacement[from];
      }
      arm.normalize();
      const Eigen::MatrixXd block = arm * arm.transpose();
      result.block(i * d, i * d, d, d) += block;
      result.block(j * d, j * d, d, d) += block;
      result.block(i * d, j * d, d, d) -= block;
      result.block(j * d, i * d, d, d) -= block;
    });
    return result;
  }

  /// Motions without stiffness of the degrees of freedom that are neither held nor pinned.
  [[nodiscard]] int soft_motions(const std::vector<char>& pinned) const {
    std::vector<int> free;
    for (std::size_t dof = 0; dof < prescribed.size(); ++dof) {
      if (!prescribed[dof] && !pinned[dof]) free.push_back(static_cast<int>(dof));
    }
    if (free.empty()) return 0;
    const Eigen::MatrixXd matrix = stiffness()(free, free);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix, Eigen::EigenvaluesOnly);
    return static_cast<int>((solver.eigenvalues().array() < 1e-9).count());
  }
};

int total(const std::vector<char>& flags) { return std::accumulate(flags.begin(), flags.end(), 0); }

/// Degrees of freedom of a point that are pinned.
std::vector<int> pins_of(const Fragments& fragments, Index point, int dimension) {
  std::vector<int> pins;
  for (int c = 0; c < dimension; ++c) pins.push_back(fragments.pinned[point * dimension + c]);
  return pins;
}

/// The pins hold all, they are as few as possible, and none is prescribed.
void expect_determinate(const Web& web, const Fragments& fragments) {
  const std::vector<char> none(web.prescribed.size(), 0);
  EXPECT_EQ(web.soft_motions(none), total(fragments.pinned));
  EXPECT_EQ(web.soft_motions(fragments.pinned), 0);
  for (std::size_t dof = 0; dof < web.prescribed.size(); ++dof) {
    if (!fragments.pinned[dof]) continue;
    EXPECT_FALSE(web.prescribed[dof]) << dof;
    std::vector<char> fewer = fragments.pinned;
    fewer[dof] = 0;
    EXPECT_EQ(web.soft_motions(fewer), 1) << dof;
  }
}

/// A block of each dimension, its face x = 0 held.
Web held_block(int dimension) {
  Web web(dimension);
  const int across = dimension > 1 ? 4 : 1, deep = dimension > 2 ? 3 : 1;
  web.add_block({6, across, deep}).bond();
  for (Index i = 0; i < across * deep; ++i) web.hold({i});
  return web;
}

TEST(Fragments, AreNoneOfAnIntactBody) {
  for (int dimension : {1, 2, 3}) {
    const Web web = held_block(dimension);
    for (std::span<const char> broken : {std::span<const char>{}, std::span(web.broken)}) {
      const Fragments fragments = find_fragments(web.points, web.bonds, broken, web.prescribed,
                                                 web.displacement, {web.prescribed});
      EXPECT_EQ(fragments.count, 0);
      EXPECT_EQ(fragments.piece, std::vector<std::int32_t>(web.points.volume.size(), 0));
      EXPECT_TRUE(fragments.loose.empty());
      EXPECT_EQ(fragments.pinned, std::vector<char>(web.prescribed.size(), 0));
    }
  }
}

TEST(Fragments, OfABodyCutInTwoAreItsFreeHalf) {
  for (int dimension : {1, 2, 3}) {
    for (double angle : {0.0, 1.1}) {
      Web web = held_block(dimension).cut(2.5);
      if (dimension > 1) web.rotate(angle);
      const Fragments fragments = web.find();
      EXPECT_EQ(fragments.count, 1);
      EXPECT_TRUE(fragments.loose.empty());
      for (Index i = 0; i < web.points.count(); ++i) {
        const bool free = web.points.position(i)[0] > 2.5;
        EXPECT_EQ(fragments.piece[i], free) << i;
        if (free) continue;
        EXPECT_EQ(pins_of(fragments, i, dimension), std::vector<int>(dimension, 0)) << i;
      }
      EXPECT_EQ(total(fragments.pinned), dimension * (dimension + 1) / 2);
      expect_determinate(web, fragments);

      Web pinned = web;
      for (std::size_t dof = 0; dof < pinned.prescribed.size(); ++dof) {
        pinned.prescribed[dof] = pinned.prescribed[dof] || fragments.pinned[dof];
      }
      const Fragments none = pinned.find();
      EXPECT_EQ(none.count, 0);
      EXPECT_EQ(total(none.pinned), 0);
    }
  }
}

TEST(Fragments, AreHeldByPinsFarApart) {
  Web web = held_block(2).cut(2.5);
  const Fragments fragments = web.find();
  std::vector<Index> at;
  for (Index i = 0; i < web.points.count(); ++i) {
    for (int c = 0; c < 2; ++c) {
      if (fragments.pinned[i * 2 + c]) at.push_back(i);
    }
  }
  ASSERT_EQ(at.size(), 3u);
  double widest = 0.0;
  for (Index a : at) {
    for (Index b : at) {
      widest = std::max(widest, tests::reference_distance(web.points, a, b));
    }
  }
  EXPECT_GE(widest, 3.0);  // of a half of 2 x 3
}

TEST(Fragments, OnRollersNeedTheMissingPinsOnly) {
  // The far half rolls on its face x = 5: it may still move along y (2D); along y and z, and turn
  // about x (3D).
  for (int dimension : {2, 3}) {
    Web web = held_block(dimension).cut(2.5);
    for (Index i = 0; i < web.points.count(); ++i) {
      if (web.points.position(i)[0] == 5.0) web.hold(i, 0);
    }
    const Fragments fragments = web.find();
    EXPECT_EQ(fragments.count, 1);
    EXPECT_EQ(total(fragments.pinned), dimension == 2 ? 1 : 3);
    expect_determinate(web, fragments);
  }
}

TEST(Fragments, OnSufficientSupportsOfTheirOwnDoNotFloat) {
  Web web = held_block(2).cut(2.5);
  web.hold({20}).hold(23, 0);
  const Fragments fragments = web.find();
  EXPECT_EQ(fragments.count, 0);
  EXPECT_EQ(total(fragments.pinned), 0);
}

TEST(Fragments, AreNumberedBySizeThenByLowestPoint) {
  Web web(2);
  web.add_block({2, 2, 1}).add_block({3, 2, 1}, {10.0}).add({{20.0}}).add_block({2, 2, 1}, {30.0});
  web.add_block({2, 2, 1}, {40.0}).bond().hold({15, 16});
  web.hold({11, 12});
  const Fragments fragments = web.find();
  EXPECT_EQ(fragments.count, 3);
  EXPECT_EQ(fragments.piece, (std::vector<std::int32_t>{2, 2, 2, 2, 1, 1, 1, 1, 1, 1,  //
                                                        3, 0, 0, 0, 0, 0, 0, 0, 0}));
}

/// A held block of 6 x 4 points and, above the middle of its face x = 5, a point more.
Web block_with_a_tip() {
  Web web(2);
  web.add_block({6, 4, 1}).add({{6.0, 1.0}}).bond();
  for (Index i = 0; i < 4; ++i) web.hold({i});
  return web;
}

constexpr Index tip = 24, below = 21, beside = 22, beneath = 20;  // the tip's partners: y = 1, 2, 0

TEST(Fragments, LeaveAPointOnTwoIndependentBondsAlone) {
  Web web = block_with_a_tip().leave(tip, {below, beside});
  const Fragments fragments = web.find();
  EXPECT_EQ(fragments.count, 0);
  EXPECT_TRUE(fragments.loose.empty());
  EXPECT_EQ(total(fragments.pinned), 0);
}

TEST(Fragments, HoldAPointOnOneBondAcross) {
  Web web = block_with_a_tip().leave(tip, {below});
  const Fragments fragments = web.find();
  EXPECT_EQ(fragments.count, 0);
  EXPECT_EQ(fragments.loose, (std::vector<Index>{tip}));
  EXPECT_EQ(pins_of(fragments, tip, 2), (std::vector<int>{0, 1}));
  expect_determinate(web, fragments);

  web.hold(tip, 1);  // what was missing
  EXPECT_TRUE(web.find().loose.empty());
  EXPECT_EQ(total(web.find().pinned), 0);
}

TEST(Fragments, TakeParallelBondsForOne) {
  // A point between two blocks hangs on a point of the left one and, in the same line, on another
  // one of the left or one of the right.
  for (double far : {5.0, 9.0}) {
    Web web(2);
    web.add_block({3, 4, 1}, {5.0}).add_block({2, 4, 1}, {9.0});
    web.add({{8.0, 2.0}}).bond(3.3);
    const Index point = 20;
    for (Index i : {0, 1, 2, 3, 16, 17, 18, 19}) web.hold({i});
    std::vector<Index> partners;
    for (Index i = 0; i < 20; ++i) {
      const Coordinates at = web.points.position(i);
      if (at[1] == 2.0 && (at[0] == 7.0 || at[0] == far)) partners.push_back(i);
    }
    ASSERT_EQ(partners.size(), 2u);
    web.leave(point, partners);
    const Fragments fragments = web.find();
    EXPECT_EQ(fragments.loose, (std::vector<Index>{point}));
    EXPECT_EQ(pins_of(fragments, point, 2), (std::vector<int>{0, 1}));
    expect_determinate(web, fragments);
  }
}

TEST(Fragments, TellDirectionsApartFromAThousandthOn) {
  // Two bonds of unit length at this angle.
  for (double angle : {1e-12, 0.9e-3, 1.1e-3}) {
    Web web(2);
    web.add({{0.0, 0.0}, {1.0, 0.0}, {1.0 - std::cos(angle), std::sin(angle)}}).bond(1.01);
    web.hold({0, 2});
    const Fragments fragments = web.find();
    EXPECT_EQ(fragments.loose.empty(), angle > 1e-3) << angle;
    EXPECT_EQ(pins_of(fragments, 1, 2), (std::vector<int>{0, angle < 1e-3})) << angle;
  }
}

TEST(Fragments, HoldAPointOnNoBondWhereItIs) {
  Web web = block_with_a_tip().leave(tip, {});
  Fragments fragments = web.find();
  EXPECT_EQ(fragments.count, 1);
  EXPECT_EQ(fragments.piece[tip], 1);
  EXPECT_EQ(fragments.loose, (std::vector<Index>{tip}));
  EXPECT_EQ(pins_of(fragments, tip, 2), (std::vector<int>{1, 1}));
  expect_determinate(web, fragments);

  web.hold(tip, 0);
  fragments = web.find();
  EXPECT_EQ(fragments.count, 1);
  EXPECT_EQ(pins_of(fragments, tip, 2), (std::vector<int>{0, 1}));

  web.hold(tip, 1);
  fragments = web.find();
  EXPECT_EQ(fragments.count, 0);
  EXPECT_TRUE(fragments.loose.empty());
  EXPECT_EQ(total(fragments.pinned), 0);
}

TEST(Fragments, HoldAPointOnTwoBondsIn3DByOnePin) {
  Web web(3);
  web.add_block({4, 3, 3}).add({{4.0, 1.0, 1.0}}).bond();
  for (Index i = 0; i < 9; ++i) web.hold({i});
  web.leave(36, {31, 34});  // (3, 1, 1) and (3, 2, 1): in the plane z = 1
  Fragments fragments = web.find();
  EXPECT_EQ(fragments.count, 0);
  EXPECT_EQ(fragments.loose, (std::vector<Index>{36}));
  EXPECT_EQ(pins_of(fragments, 36, 3), (std::vector<int>{0, 0, 1}));
  expect_determinate(web, fragments);

  web.leave(36, {31});
  fragments = web.find();
  EXPECT_EQ(pins_of(fragments, 36, 3), (std::vector<int>{0, 1, 1}));
  expect_determinate(web, fragments);
}

TEST(Fragments, TakeDirectionsFromThePresentState) {
  // Turned by 90 degrees, the bond along x lies along y.
  Web web = block_with_a_tip().leave(tip, {below}).rotate(std::acos(0.0));
  Fragments fragments = web.find();
  EXPECT_EQ(pins_of(fragments, tip, 2), (std::vector<int>{1, 0}));
  expect_determinate(web, fragments);

  // Two bonds of a straight angle in the present state only.
  web = block_with_a_tip().leave(tip, {beneath, beside});
  EXPECT_TRUE(web.find().loose.empty());
  web.displacement[tip * 2] = -1.0;
  fragments = web.find();
  EXPECT_EQ(fragments.loose, (std::vector<Index>{tip}));
  EXPECT_EQ(pins_of(fragments, tip, 2), (std::vector<int>{1, 0}));
  expect_determinate(web, fragments);
}

TEST(Fragments, StripChains) {
  Web web(2);
  web.add({{7.0, 1.0}}).add_block({6, 4, 1}).add({{6.0, 1.0}}).bond();
  for (Index i = 1; i < 5; ++i) web.hold({i});
  web.leave(0, {25}).leave(25, {0, 22});  // (5, 1) - (6, 1) - (7, 1)
  const Fragments fragments = web.find();
  EXPECT_EQ(fragments.count, 0);
  EXPECT_EQ(fragments.loose, (std::vector<Index>{0, 25}));
  EXPECT_EQ(pins_of(fragments, 25, 2), (std::vector<int>{0, 1}));
  EXPECT_EQ(pins_of(fragments, 0, 2), (std::vector<int>{0, 1}));  // it follows along x
  expect_determinate(web, fragments);
}

TEST(Fragments, StripTrees) {
  // A stem of one bond with three branches.
  Web web = block_with_a_tip();
  web.add({{7.0, 1.0}, {8.0, 1.0}, {7.0, 2.0}, {7.0, 0.0}}).bond(1.01).hold({0, 1, 2, 3});
  // Without diagonals the squares shear: only the points to the right count here.
  for (Index i = 4; i < tip; ++i) web.hold({i});
  const Fragments fragments = web.find();
  EXPECT_EQ(fragments.loose, (std::vector<Index>{24, 25, 26, 27, 28}));
  EXPECT_EQ(total(fragments.pinned), 5);
  expect_determinate(web, fragments);
}

/// Points that are loose by a look at all bonds in every round.
std::vector<Index> loose_by_all_bonds(const Web& web) {
  const int d = web.points.dimension;
  std::vector<char> is_loose(web.points.volume.size(), 0);
  for (bool goes_on = true; goes_on;) {
    std::vector<Eigen::Matrix3d> support(is_loose.size(), Eigen::Matrix3d::Zero());
    tests::for_each_bond(web.bonds, [&](Index i, Index j, Offset bond) {
      if (web.broken[bond]) return;
      const Coordinates a = web.points.position(i), b = web.points.position(j);
      const Eigen::Vector3d n = Eigen::Vector3d(b[0] - a[0], b[1] - a[1], b[2] - a[2]).normalized();
      if (!is_loose[j]) support[std::size_t(i)] += n * n.transpose();
      if (!is_loose[i]) support[std::size_t(j)] += n * n.transpose();
    });
    goes_on = false;
    for (std::size_t i = 0; i < is_loose.size(); ++i) {
      for (int c = 0; c < 3; ++c) {
        if (c >= d || web.prescribed[i * d + c]) support[i](c, c) += 1.0;
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spectrum(support[i]);
      if (is_loose[i] || spectrum.eigenvalues()[0] > 1e-6) continue;
      is_loose[i] = goes_on = true;
    }
  }
  std::vector<Index> loose;
  for (std::size_t i = 0; i < is_loose.size(); ++i) {
    if (is_loose[i]) loose.push_back(Index(i));
  }
  return loose;
}

TEST(Fragments, FindTheLoosePointsOfRandomNetworks) {
  std::size_t with_loose = 0, without = 0;
  for (const double share : {0.2, 0.5, 0.7, 0.8}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Web web(seed % 2 == 0 ? 2 : 3);
      web.add_block(seed % 2 == 0 ? std::array{9, 6, 1} : std::array{5, 4, 4}).bond(2.3);
      tests::Random random(seed);
      web.break_if([&](const Coordinates&, const Coordinates&) {
        return std::abs(random.number()) < share;
      });
      web.hold(Index(seed % 7), 0).hold({Index(3 * seed % 50)});
      const std::vector<Index> expected = loose_by_all_bonds(web);
      EXPECT_EQ(web.find().loose, expected) << "share " << share << ", seed " << seed;
      ++(expected.empty() ? without : with_loose);
    }
  }
  EXPECT_GT(with_loose, 10u);
  EXPECT_GT(without, 10u);
}

TEST(Fragments, OfAFewPointsAreHeldLikeRigidBodies) {
  for (int dimension : {1, 2, 3}) {
    const int points_of_most = dimension == 1 ? 3 : 4;
    for (int count = 1; count <= points_of_most; ++count) {
      // Up to three points in a triangle; the fourth makes it a tetrahedron or a square.
      Web web(dimension);
      const Place places[] = {{0.0, 0.0, 0.0}, {1.0, 0.1, 0.0}, {0.2, 1.0, 0.1}, {0.9, 0.8, 0.9}};
      for (int k = 0; k < count; ++k) web.add({places[k]});
      web.bond(2.0);
      const Fragments fragments = web.find();
      EXPECT_EQ(fragments.count, 1);
      EXPECT_EQ(fragments.piece, std::vector<std::int32_t>(std::size_t(count), 1));
      const bool stiff = dimension == 1 ? count > 1 : count > dimension;
      EXPECT_EQ(fragments.loose.size(), stiff ? 0u : std::size_t(count));
      expect_determinate(web, fragments);
    }
  }
}

TEST(Fragments, OfAFewPointsInARowMayBend) {
  for (int dimension : {2, 3}) {
    Web web(dimension);
    web.add_block({5, 1, 1}).bond();
    const Fragments fragments = web.find();
    EXPECT_EQ(fragments.loose.size(), 5u);
    EXPECT_EQ(total(fragments.pinned), 5 * dimension - 4);
    expect_determinate(web, fragments);
  }
}

TEST(Fragments, HoldABlockThatHangsOnALoosePoint) {
  Web web(2);
  web.add_block({3, 3, 1}).add({{3.0, 1.0}}).add_block({3, 3, 1}, {4.0}).bond().hold({0, 1, 2});
  web.leave(9, {7, 11});  // (2, 1) - (3, 1) - (4, 1)
  const Fragments fragments = web.find();
  EXPECT_EQ(fragments.count, 0);  // as one body it is held
  EXPECT_EQ(fragments.loose, (std::vector<Index>{9}));
  EXPECT_EQ(total(fragments.pinned), 4);  // of the block, that the chain holds along x, and of 9
  EXPECT_EQ(web.soft_motions(fragments.pinned), 0);
}

TEST(Fragments, OfFewPointsMindTheirSupports) {
  Web web(2);
  web.add({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}}).bond(1.01).hold(0, 0).hold(2, 1);
  const Fragments fragments = web.find();
  EXPECT_EQ(fragments.count, 1);  // it may turn about (2, 0)
  expect_determinate(web, fragments);
}

}  // namespace
}  // namespace peristat
