#include "src/materials/quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"
#include "src/geometry/box_in_ball.hpp"
#include "src/geometry/lattice.hpp"
#include "src/neighbourhood/influence.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxSetting;
using tests::for_each_bond;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

const tests::Quadrature all_quadratures[] = {
    {VolumeCorrection::none, SurfaceCorrection::none},
    {VolumeCorrection::linear, SurfaceCorrection::none},
    {VolumeCorrection::none, SurfaceCorrection::volume},
    {VolumeCorrection::linear, SurfaceCorrection::volume},
    {VolumeCorrection::none, SurfaceCorrection::energy},
    {VolumeCorrection::linear, SurfaceCorrection::energy},
    {VolumeCorrection::exact, SurfaceCorrection::none},
    {VolumeCorrection::exact_centroids, SurfaceCorrection::energy}};

/// A box that has points whose neighbours' neighbours are all present.
BoxSetting deep_box(int dimension, const tests::Quadrature& quadrature) {
  BoxSetting box = tests::small_box(dimension);
  box.extent = dimension == 1   ? std::array<int, 3>{30, 0, 0}
               : dimension == 2 ? std::array<int, 3>{14, 13, 0}
                                : std::array<int, 3>{12, 11, 11};
  box.quadrature = quadrature;
  return box;
}

/// Distance to the faces beyond which a point's neighbours have all their neighbours.
double depth(const BoxSetting& box) { return (2.0 * box.horizon_ratio + 1.0) * box.spacing; }

/// Ratio of the discrete energy density to the classical one under a confined unit strain along an
/// axis: sums over ordered pairs, half of each bond's c s^2 L/2 w at either point.
std::vector<double> confined_energy(const tests::BoxBody& body, int axis) {
  std::vector<double> energy(body.points.volume.size(), 0.0);
  const double modulus = micromodulus(1.0, body.setting);
  for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset bond) {
    const double length = tests::reference_distance(body.points, i, j);
    const double n = (body.points.position(j)[axis] - body.points.position(i)[axis]) / length;
    const double whole = 0.5 * modulus * std::pow(n, 4) * length * body.model.bonds().weight(bond);
    energy[i] += 0.5 * whole / body.points.volume[i];
    energy[j] += 0.5 * whole / body.points.volume[j];
  });
  for (double& of_point : energy) of_point /= confined_energy_per_modulus(body.setting);
  return energy;
}

TEST(LinearPartialVolume, FallsLinearlyOverOneSizeAboutTheHorizon) {
  EXPECT_EQ(linear_partial_volume(2.0, 3.0, 1.0), 1.0);
  EXPECT_EQ(linear_partial_volume(2.5, 3.0, 1.0), 1.0);
  EXPECT_DOUBLE_EQ(linear_partial_volume(2.75, 3.0, 1.0), 0.75);
  EXPECT_DOUBLE_EQ(linear_partial_volume(3.0, 3.0, 1.0), 0.5);
  EXPECT_DOUBLE_EQ(linear_partial_volume(3.25, 3.0, 1.0), 0.25);
  EXPECT_EQ(linear_partial_volume(3.5, 3.0, 1.0), 0.0);
  EXPECT_EQ(linear_partial_volume(4.0, 3.0, 1.0), 0.0);
  EXPECT_DOUBLE_EQ(linear_partial_volume(3.0, 3.0, 0.25), 0.5);
  EXPECT_DOUBLE_EQ(linear_partial_volume(3.0625, 3.0, 0.25), 0.25);
}

TEST(MakeBonds, WeighsWithTheProductOfVolumesWithoutCorrections) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    Points points = tests::box_points(tests::small_box(dimension));
    tests::Random random(1);
    for (double& volume : points.volume) volume *= 1.0 + 0.5 * random.number();
    const tests::BoxBody body(points, tests::small_box(dimension));
    ASSERT_GT(body.model.bonds().count(), 20);
    for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset bond) {
      EXPECT_DOUBLE_EQ(body.model.bonds().weight(bond), points.volume[i] * points.volume[j]);
    });
  }
}

TEST(MakeBonds, AveragesTheLinearPartialVolumesOfBothPoints) {
  BoxSetting box = tests::small_box(2);
  box.quadrature.volume = VolumeCorrection::linear;
  Points points = tests::box_points(box);
  tests::Random random(1);
  for (double& volume : points.volume) volume *= 1.0 + 0.3 * random.number();
  const tests::BoxBody body(points, box);
  const double horizon = body.setting.horizon;
  double widest = 0.0;
  Offset partial = 0;
  std::map<std::pair<Index, Index>, double> weight;
  for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset bond) {
    weight[{i, j}] = body.model.bonds().weight(bond);
  });
  for (Index i = 0; i < points.count(); ++i) {
    for (Index j = i + 1; j < points.count(); ++j) {
      const double distance = tests::reference_distance(points, i, j);
      const auto share = [&](Index of) {
        const double size = std::sqrt(points.volume[of] / box.cross_section);
        return std::clamp((horizon + 0.5 * size - distance) / size, 0.0, 1.0);
      };
      const double mean = 0.5 * (share(i) + share(j));
      const auto found = weight.find({i, j});
      const double actual = found == weight.end() ? 0.0 : found->second;
      EXPECT_NEAR(actual / (points.volume[i] * points.volume[j]), mean, 1e-8);
      if (found != weight.end()) widest = std::max(widest, distance);
      partial += mean > 0.0 && mean < 1.0;
    }
  }
  EXPECT_GT(widest, horizon);  // shares of cells whose centres lie outside
  EXPECT_GT(partial, 50);
}

// A cell at the corner of the neighbourhood, of radius 2.015 about a point of squares of edge 1:
// the same as its part found alone, on a lattice that is turned, too.
TEST(MakeBonds, WeighsWithThePartsOfCells) {
  for (const double angle : {0.0, 25.0}) {
    for (const auto volume : {VolumeCorrection::exact, VolumeCorrection::exact_centroids}) {
      Lattice lattice;
      lattice.dimension = 2;
      lattice.angle = angle;
      lattice.spacing = Spacing({0.1, 0.12, 0.0}, 2);
      lattice.shapes = {{ShapeStep::Action::add, Box{{-1, -1, 0}, {1, 1, 0}}}};
      const Points points = make_points(lattice);
      BondSetting setting{{2, 0.24, 1.0, volume}, PlaneState::stress};
      setting.influence = influence_named("gaussian");
      const Bonds bonds = make_bonds(points, SurfaceCorrection::none, setting, 1);
      const double turn = angle * std::numbers::pi / 180.0;
      Offset cut = 0, beyond = 0;
      for_each_bond(bonds, [&](Index i, Index j, Offset bond) {
        const Coordinates from = points.position(i), to = points.position(j);
        const double x = to[0] - from[0], y = to[1] - from[1];
        const Coordinates along{std::cos(turn) * x + std::sin(turn) * y,
                                std::cos(turn) * y - std::sin(turn) * x, 0.0};
        const BoxPart part = box_in_ball(along, {0.1, 0.12, 0.0}, 0.24, 2);
        const double nodes = std::hypot(x, y),
                     centroid = std::hypot(part.centroid[0], part.centroid[1]);
        const bool is_exact = volume == VolumeCorrection::exact;
        const double counted = is_exact ? nodes : centroid;
        const double expected = points.volume[i] * points.volume[j] * part.share *
                                std::exp(-std::pow(counted / 0.24, 2)) * counted / nodes;
        EXPECT_NEAR(bonds.weight(bond) / expected, 1.0, 1e-9);  // of parts of a millionth of a cell
        cut += part.share < 1.0;
        beyond += nodes > 0.24;
      });
      EXPECT_GT(cut, 100);
      EXPECT_GT(beyond, 100);
    }
  }
}

TEST(MakeBonds, SeesTheWholeBallByThePartsOfCells) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const tests::BoxBody body(
        deep_box(dimension, {VolumeCorrection::exact, SurfaceCorrection::none}));
    const auto seen = seen_volumes(body.points, body.model.bonds(), body.setting, {});
    const double most = *std::max_element(seen.begin(), seen.end());
    const double own = body.points.volume.front();
    EXPECT_NEAR((most + own) / body.setting.moment(0), 1.0, 1e-14 * 200);  // sums of 10^2 terms
    EXPECT_NEAR(
        (body.setting.lattice_moment(0, body.points.spacing) + own) / body.setting.moment(0), 1.0,
        1e-14);
  }
}

TEST(MakeBonds, RefusesPartsOfCellsThatAreNotThere) {
  BoxSetting box = tests::small_box(2);
  box.quadrature.volume = VolumeCorrection::exact;
  Points cut = tests::box_points(box), cloud = cut, moved = cut;
  cut.volume[5] *= 0.5;
  cloud.lattice.reset();
  moved.reference[4] += 0.01 * box.spacing;
  for (const Points& points : {cut, cloud, moved}) {
    EXPECT_THROW(tests::BoxBody(points, box), InputError);
  }
  EXPECT_NO_THROW(tests::BoxBody{box});
}

TEST(MakeBonds, IsSymmetricInTheTwoPoints) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (const tests::Quadrature& quadrature : all_quadratures) {
      BoxSetting box = tests::small_box(dimension);
      box.quadrature = quadrature;
      Points points = tests::box_points(box);
      tests::Random random(2);
      for (double& volume : points.volume) {
        volume *= tests::bond_setting(box).has_exact_shares() ? 1.0 : 1.0 + 0.3 * random.number();
      }
      // The same points numbered backwards: every bond has its points swapped.
      Points backwards = points;
      std::reverse(backwards.volume.begin(), backwards.volume.end());
      const Index last = points.count() - 1;
      for (Index i = 0; i <= last; ++i) {
        for (int c = 0; c < dimension; ++c) {
          backwards.reference[std::size_t(last - i) * dimension + c] = points.position(i)[c];
        }
      }
      const tests::BoxBody one(points, box), other(backwards, box);
      std::map<std::pair<Index, Index>, double> weight;
      for_each_bond(other.model.bonds(), [&](Index i, Index j, Offset bond) {
        weight[{last - j, last - i}] = other.model.bonds().weight(bond);
      });
      ASSERT_GT(one.model.bonds().count(), 20);
      ASSERT_EQ(std::size_t(one.model.bonds().count()), weight.size());
      for_each_bond(one.model.bonds(), [&](Index i, Index j, Offset bond) {
        // Sums over a neighbourhood in another order: some round-offs.
        EXPECT_NEAR(one.model.bonds().weight(bond) / (weight.at({i, j})), 1.0, 64 * epsilon);
      });
    }
  }
}

TEST(MakeBonds, HasOnlyPositiveWeights) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (const tests::Quadrature& quadrature : all_quadratures) {
      const tests::BoxBody body(deep_box(dimension, quadrature));
      ASSERT_GT(body.model.bonds().count(), 0);
      for (const BondKind& kind : tests::kinds(body.model.bonds())) EXPECT_GT(kind.weight, 0.0);
    }
  }
}

TEST(MakeBonds, GivesTheSameForAnyNumberOfThreads) {
  for (const tests::Quadrature& quadrature : all_quadratures) {
    BoxSetting box = tests::small_box(3);
    box.quadrature = quadrature;
    const tests::BoxBody one(box, 1), three(box, 3);
    EXPECT_EQ(tests::upper_points(one.model.bonds()), tests::upper_points(three.model.bonds()));
    EXPECT_EQ(tests::kinds(one.model.bonds()), tests::kinds(three.model.bonds()));
  }
}

// mu = 2 V_H / (V_i + V_j): undone, the bond has its uncorrected weight; inside the bulk, where
// both neighbourhoods are whole, mu is 1; and the corrected neighbourhoods of points at the surface
// come nearer to the bulk's V_H.
TEST(VolumeMethod, ScalesByTheMissingNeighbourhood) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (VolumeCorrection volume : {VolumeCorrection::none, VolumeCorrection::linear}) {
      const BoxSetting box = deep_box(dimension, {volume, SurfaceCorrection::volume});
      const tests::BoxBody plain(deep_box(dimension, {volume, SurfaceCorrection::none}));
      const tests::BoxBody corrected(box);
      const auto neighbourhoods = [&](const tests::BoxBody& body) {
        std::vector<double> sums(body.points.volume.size(), 0.0);
        for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset bond) {
          sums[i] += body.model.bonds().weight(bond) / body.points.volume[i];
          sums[j] += body.model.bonds().weight(bond) / body.points.volume[j];
        });
        return sums;
      };
      const std::vector<double> before = neighbourhoods(plain), after = neighbourhoods(corrected);
      const double bulk = *std::max_element(before.begin(), before.end());
      ASSERT_EQ(tests::upper_points(plain.model.bonds()),
                tests::upper_points(corrected.model.bonds()));
      Offset in_bulk = 0, at_surface = 0;
      for_each_bond(plain.model.bonds(), [&](Index i, Index j, Offset bond) {
        const double factor =
            corrected.model.bonds().weight(bond) / plain.model.bonds().weight(bond);
        EXPECT_NEAR(factor * (before[i] + before[j]) / (2.0 * bulk), 1.0, 1e-13);
        const double whole = (box.horizon_ratio + 0.5) * box.spacing;
        const bool inside = tests::is_inside(plain.points, i, box, whole) &&
                            tests::is_inside(plain.points, j, box, whole);
        if (inside) {
          EXPECT_NEAR(factor, 1.0, 1e-13);
        }
        in_bulk += inside;
        at_surface += factor > 1.1;
      });
      EXPECT_GT(in_bulk, 10);
      EXPECT_GT(at_surface, 3);
      const auto worst = [&](const std::vector<double>& sums) {
        return 1.0 - *std::min_element(sums.begin(), sums.end()) / bulk;
      };
      EXPECT_GT(worst(before), 0.3);
      EXPECT_LT(std::abs(worst(after)), 0.75 * worst(before));
    }
  }
}

TEST(EnergyMethod, MakesTheConfinedEnergyClassicalInTheBulk) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (VolumeCorrection volume : {VolumeCorrection::none, VolumeCorrection::linear}) {
      for (PlaneState plane : {PlaneState::stress, PlaneState::strain}) {
        BoxSetting box = deep_box(dimension, {volume, SurfaceCorrection::energy});
        box.plane = plane;
        const tests::BoxBody corrected(box);
        box.quadrature.surface = SurfaceCorrection::none;
        const tests::BoxBody plain(box);
        for (int axis = 0; axis < dimension; ++axis) {
          const std::vector<double> energy = confined_energy(corrected, axis);
          const std::vector<double> uncorrected = confined_energy(plain, axis);
          int deep = 0;
          for (Index i = 0; i < corrected.points.count(); ++i) {
            if (!tests::is_inside(corrected.points, i, box, depth(box))) continue;
            ++deep;
            EXPECT_NEAR(energy[i], 1.0, 1e-13);
            EXPECT_GT(std::abs(uncorrected[i] - 1.0), 1e-5);  // the lattice alone is not
          }
          EXPECT_GT(deep, 0);
        }
      }
    }
  }
}

TEST(EnergyMethod, ReducesTheErrorAtSurfaces) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (VolumeCorrection volume : {VolumeCorrection::none, VolumeCorrection::linear}) {
      const tests::BoxBody plain(deep_box(dimension, {volume, SurfaceCorrection::none}));
      const tests::BoxBody corrected(deep_box(dimension, {volume, SurfaceCorrection::energy}));
      // Over all points at the surface, along all axes; the mean, since a sharper worst case may
      // stand at a corner.
      double before = 0.0, after = 0.0;
      for (int axis = 0; axis < dimension; ++axis) {
        for (double energy : confined_energy(plain, axis)) before += std::abs(energy - 1.0);
        for (double energy : confined_energy(corrected, axis)) after += std::abs(energy - 1.0);
      }
      ASSERT_GT(before, 0.0);
      EXPECT_LT(after, 0.75 * before) << dimension << "D";
      EXPECT_LT(confined_energy_error(corrected.points, corrected.model.bonds(), corrected.setting),
                confined_energy_error(plain.points, plain.model.bonds(), plain.setting))
          << dimension << "D";
    }
  }
}

// Cells that are polygons: every pair whose cells reach into the other's horizon has a bond of the
// mean of both parts, and nobody else has one; the search looks as far as corners reach.
TEST(Bonds, OfPolygonsHaveTheMeanOfTheirParts) {
  Lattice lattice;
  lattice.spacing = 0.1;
  lattice.shapes = {{ShapeStep::Action::add, Box{{0, 0, 0}, {1.2, 1.0, 0}}}};
  for (const bool is_random : {false, true}) {
    lattice.arrangement = is_random ? Arrangement::blue_noise : Arrangement::lattice;
    lattice.cell_perturbation = is_random ? 0.0 : 0.24;
    const Points points = make_points(lattice);
    BondSetting setting;
    setting.horizon = 0.25;
    setting.volume_correction = VolumeCorrection::exact;
    const Bonds bonds = make_bonds(points, SurfaceCorrection::none, setting, 1);
    std::map<std::pair<Index, Index>, double> found;
    for (Index i = 0; i < points.count(); ++i) {
      for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond)
        found[{i, bonds.partner(i, bond)}] = bonds.weight(bond);
    }
    std::size_t expected = 0, cut = 0;
    for (Index i = 0; i < points.count(); ++i) {
      for (Index j = i + 1; j < points.count(); ++j) {
        const auto part = [&](Index of, Index about) {
          const Coordinates at = points.position(of), from = points.position(about);
          std::vector<PlaneVector> corners = points.polygons.of(std::size_t(of));
          for (PlaneVector& corner : corners)
            for (std::size_t c = 0; c < 2; ++c) corner[c] += at[c] - from[c];
          const double share = polygon_in_disk(corners, 0.25).area / points.volume[std::size_t(of)];
          cut += share > 1e-9 && share < 1.0 - 1e-9;
          return share < least_share ? 0.0 : share;
        };
        const double both = 0.5 * (part(i, j) + part(j, i));
        if (both == 0.0) continue;
        ++expected;
        const double weight = both * points.volume[std::size_t(i)] * points.volume[std::size_t(j)];
        const auto bond = found.find({i, j});
        ASSERT_NE(bond, found.end());
        EXPECT_NEAR(bond->second / weight, 1.0, 1e-9);
      }
    }
    EXPECT_EQ(found.size(), expected);
    EXPECT_GT(cut, 500u);
  }
}

// Where a cell is no polygon nobody knows its part: a round rim, and polyhedra.
TEST(Bonds, OfCutVoronoiCellsHaveNoExactParts) {
  Lattice lattice;
  lattice.spacing = 0.1;
  lattice.arrangement = Arrangement::blue_noise;
  BondSetting setting;
  setting.horizon = 0.25;
  setting.volume_correction = VolumeCorrection::exact;
  const auto make = [&] {
    static_cast<void>(make_bonds(make_points(lattice), SurfaceCorrection::none, setting, 1));
  };
  lattice.shapes = {{ShapeStep::Action::add, Disk{{0, 0, 0}, 0.6}}};
  EXPECT_THROW(make(), InputError);
  lattice.shapes = {{ShapeStep::Action::add, Box{{0, 0, 0}, {0.6, 0.6, 0.6}}}};
  EXPECT_NO_THROW(make());
  lattice.dimension = setting.dimension = 3;
  EXPECT_THROW(make(), InputError);
}

TEST(ConfinedEnergyError, IsTheLargestOverPointsAndAxes) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const tests::BoxBody body(deep_box(dimension, {}));
    double expected = 0.0;
    for (int axis = 0; axis < dimension; ++axis) {
      for (double energy : confined_energy(body, axis)) {
        expected = std::max(expected, std::abs(energy - 1.0));
      }
    }
    ASSERT_GT(expected, 0.3);
    EXPECT_NEAR(confined_energy_error(body.points, body.model.bonds(), body.setting), expected,
                1e-13);
  }
}

}  // namespace
}  // namespace peristat
