#include "src/materials/bulk_bonds.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "src/geometry/lattice.hpp"
#include "src/materials/quadrature.hpp"

namespace peristat {
namespace {

struct Example {
  int dimension;
  Spacing spacing;
  double angle;
  VolumeCorrection volume;
  SurfaceCorrection surface;
};

const std::vector<Example> examples{
    {1, 0.1, 0.0, VolumeCorrection::linear, SurfaceCorrection::energy},
    {2, 0.1, 0.0, VolumeCorrection::none, SurfaceCorrection::none},
    {2, 0.1, 30.0, VolumeCorrection::linear, SurfaceCorrection::energy},
    {2, {{0.1, 0.14, 0.0}, 2}, 20.0, VolumeCorrection::none, SurfaceCorrection::energy},
    {3, 0.1, 0.0, VolumeCorrection::linear, SurfaceCorrection::volume},
    {3, {{0.1, 0.12, 0.09}, 3}, 40.0, VolumeCorrection::none, SurfaceCorrection::energy},
    {1, 0.1, 0.0, VolumeCorrection::exact_centroids, SurfaceCorrection::none},
    {2, 0.1, 30.0, VolumeCorrection::exact, SurfaceCorrection::energy},
    {2, {{0.1, 0.14, 0.0}, 2}, 20.0, VolumeCorrection::exact_centroids, SurfaceCorrection::none},
    {3, {{0.1, 0.12, 0.09}, 3}, 40.0, VolumeCorrection::exact, SurfaceCorrection::none}};

BondSetting setting_of(const Example& of, double ratio) {
  BondSetting setting{{of.dimension, ratio * of.spacing, 1.0, of.volume}, PlaneState::stress};
  setting.lattice = {of.spacing, of.angle, of.surface};
  return setting;
}

/// What the bonds of the points deep inside a real body have, of all of them the one next to the
/// origin.
struct RealBonds {
  std::vector<Coordinates> direction;
  std::vector<double> length, weight;

  RealBonds(const Example& of, const BondSetting& setting) {
    Lattice lattice;
    lattice.dimension = of.dimension;
    lattice.spacing = of.spacing;
    lattice.angle = of.angle;
    lattice.cross_section = 1.0;
    const double half = 2.0 * setting.horizon + 3.0 * of.spacing.largest();
    lattice.shapes = {{ShapeStep::Action::add, Box{{-half, -half, -half}, {half, half, half}}}};
    const Points points = make_points(lattice);
    const Bonds bonds = make_bonds(points, of.surface, setting, 1);
    const auto distance = [&](Index i) {
      const Coordinates at = points.position(i);
      return std::hypot(at[0], at[1], at[2]);
    };
    Index middle = 0;
    for (Index i = 1; i < points.count(); ++i) {
      if (distance(i) < distance(middle)) middle = i;
    }
    for (Index i = 0; i < bonds.points(); ++i) {
      for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
        const Index j = bonds.partner(i, bond);
        if (i != middle && j != middle) continue;
        const Coordinates from = points.position(i), to = points.position(j);
        Coordinates n{};
        for (int c = 0; c < 3; ++c) n[c] = (to[c] - from[c]) * bonds.inverse_length(bond);
        direction.push_back(n);
        length.push_back(bonds.length(bond));
        weight.push_back(bonds.weight(bond) / points.volume[middle]);
      }
    }
  }
};

TEST(BulkBonds, AreThoseOfAPointDeepInsideABody) {
  for (const Example& example : examples) {
    const BondSetting setting = setting_of(example, 2.3);
    const BulkBonds bulk(setting);
    const RealBonds real(example, setting);
    ASSERT_GT(real.length.size(), 3u);
    for (const Coordinates& n : {Coordinates{1, 0, 0}, Coordinates{0.6, 0.8, 0}}) {
      if (example.dimension == 1 && n[1] != 0.0) continue;
      double crossing = 0.0, first = 0.0;
      for (std::size_t k = 0; k < real.length.size(); ++k) {
        const Coordinates& d = real.direction[k];
        crossing += 0.5 * real.weight[k] * real.length[k] * real.length[k] *
                    std::abs(d[0] * n[0] + d[1] * n[1] + d[2] * n[2]);
        first += real.weight[k] * real.length[k];
      }
      // Round-off of positions against the spacing, amplified by the corrections.
      EXPECT_NEAR(bulk.crossing(n) / crossing, 1.0, 1e-12) << example.dimension;
      EXPECT_NEAR(bulk.moment(1) / first, 1.0, 1e-12);
    }
  }
}

TEST(BulkBonds, OfALongHorizonAreThoseOfTheContinuum) {
  for (const int dimension : {2, 3}) {
    const double ratio = dimension == 2 ? 60.3 : 15.3, h = dimension == 2 ? 0.7 : 1.0;
    for (const PlaneState plane : {PlaneState::stress, PlaneState::strain}) {
      BondSetting setting{{dimension, ratio, h, VolumeCorrection::linear}, plane};
      const double crossing = mean_crossing(setting), c = micromodulus(2.5, setting);
      setting.lattice = {1.0};
      const BulkBonds bulk(setting);
      // The quadrature of a ball by cells: of the order of a part of a spacing over the horizon.
      EXPECT_NEAR(mean_crossing(setting) / crossing, 1.0, 5e-3);
      EXPECT_NEAR(bulk_micromodulus(2.5, setting) / c, 1.0, 5e-3);
      const DirectionalSpread spread = bulk.crossing();
      EXPECT_NEAR(spread.least / spread.mean, 1.0, 5e-3);
      EXPECT_NEAR(spread.most / spread.mean, 1.0, 5e-3);
      EXPECT_NEAR(c * bulk.youngs_modulus({1, 1, 0}), 2.5, 0.02);
    }
  }
}

TEST(BulkBonds, MeanLeastAndMostAreThoseOverThePlanes) {
  const BulkBonds bulk(setting_of(examples[3], 3.0));
  const DirectionalSpread spread = bulk.crossing();
  double mean = 0.0;
  constexpr int count = 20000;
  for (int k = 0; k < count; ++k) {
    const double angle = std::numbers::pi * (k + 0.5) / count;
    const double value = bulk.crossing({std::cos(angle), std::sin(angle), 0.0});
    mean += value / count;
    EXPECT_GE(value, spread.least * (1.0 - 1e-6));
    EXPECT_LE(value, spread.most * (1.0 + 1e-6));
  }
  // The midpoint rule over the kinks of |n_x|.
  EXPECT_NEAR(spread.mean / mean, 1.0, 1e-6);
  EXPECT_LT(spread.least, 0.99 * spread.most);
}

TEST(BulkBonds, AlongTheAxesAloneResistNoShear) {
  BondSetting setting{{2, 1.2, 1.0}, PlaneState::stress};
  setting.lattice = {1.0};
  EXPECT_EQ(BulkBonds(setting).youngs_modulus({1, 1, 0}), 0.0);
}

}  // namespace
}  // namespace peristat
