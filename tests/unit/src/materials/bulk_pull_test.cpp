#include "src/materials/bulk_pull.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "src/materials/cpd_constants.hpp"

namespace peristat {
namespace {

constexpr double ratio = 3.015;

BondSetting setting_of(int dimension, bool has_lattice, double angle = 0.0) {
  BondSetting setting{{dimension, ratio, 0.7, VolumeCorrection::linear}, PlaneState::stress};
  if (dimension == 3) setting.cross_section = 1.0;
  if (has_lattice) setting.lattice = {Spacing(1.0), angle, SurfaceCorrection::energy};
  return setting;
}

BulkPull pull_of(const BondSetting& setting) { return {setting, micromodulus(1.0, setting)}; }

AnyLaw linear(double critical) { return {ForceEnvelope{1.0, critical}}; }

TEST(BulkPull, OfABarIsTheLargestForceOfItsBonds) {
  const BulkPull bar = pull_of(setting_of(1, false));
  const ForceEnvelope blended{1.0, 8.0, 0.0, 0.3, 0.5};
  EXPECT_NEAR(bar.peak(Loading::tension, {blended}).mean / blended.peak_force(), 1.0, 1e-9);
  EXPECT_NEAR(bar.onset(Loading::tension, 2.0).mean, 2.0, 1e-14);
}

/// Figures of tests/reference/pull.py, which finds them by other means.
TEST(BulkPull, OfASquareLatticeIsThatOfTheReference) {
  const BulkPull lattice = pull_of(setting_of(2, true));
  EXPECT_NEAR(lattice.peak(Loading::tension, linear(4.0)).mean, 1.0883444990, 1e-8);
  EXPECT_NEAR(lattice.peak(Loading::tension, {TanhDegradation{1.0, 4.0, 3.0}}).mean, 1.9312291461,
              1e-8);
  EXPECT_NEAR(lattice.peak(Loading::tension, {CriticalStretch{1.0}}).mean, 0.9965170926, 1e-8);
}

/// Where bonds soften under shear the lattice comes near to having no stiffness: round-off must not
/// decide what it bears. The figure is that of tests/reference/pull.py [Pa].
TEST(BulkPull, OfTrianglesInShearDoesNotDependOnRoundOff) {
  for (int k = 0; k < 12; ++k) {
    const double near_one = 1.0 + 1e-13 * k;
    const BulkPull pull(Kernel{2, 2.015e-3 * near_one, 0.5}, 1e-3 * near_one,
                        {5e19 * near_one, 3e27, 0.0});
    const double strength = pull.peak(Loading::shear, {ForceEnvelope{0.002, 0.016}}).mean;
    EXPECT_NEAR(strength / 185887651.85, 1.0, 1e-8) << k;
  }
}

/// In multiples of E s_m: 1 under tension, 1/(1 - nu) biaxial, 1/(1 + nu) in shear, 1/nu under
/// compression.
TEST(BulkPull, OfTheContinuumBeginsToSoftenAsElasticityHasIt) {
  for (const int dimension : {2, 3}) {
    const double nu = dimension == 2 ? 1.0 / 3.0 : 0.25;
    const BulkPull pull = pull_of(setting_of(dimension, false));
    const double fan = dimension == 2 ? 1e-3 : 3e-2;  // of bonds that are not quite along the pull
    EXPECT_NEAR(pull.onset(Loading::tension, 1.0).mean, 1.0, fan);
    EXPECT_NEAR(pull.onset(Loading::biaxial, 1.0).mean * (1.0 - nu), 1.0, fan);
    EXPECT_NEAR(pull.onset(Loading::shear, 1.0).mean * (1.0 + nu), 1.0, fan);
    EXPECT_NEAR(pull.onset(Loading::compression, 1.0).mean * nu, 1.0, 4.0 * fan);
  }
}

TEST(BulkPull, BearsMoreTheTougherItsBondsAreAndAlikeAtEveryAngle) {
  for (const int dimension : {2, 3}) {
    const BulkPull straight = pull_of(setting_of(dimension, true));
    double before = straight.peak(Loading::tension, {CriticalStretch{1.0}}).mean;
    for (const double critical : {1.2, 4.0, 16.0}) {
      const DirectionalSpread now = straight.peak(Loading::tension, linear(critical));
      EXPECT_GT(now.mean, before);
      EXPECT_LT(now.least, now.mean);
      EXPECT_GT(now.most, now.mean);
      before = now.mean;
    }
  }
  // Without the correction by energy, which is along the axes of the body.
  const auto at_angle = [](double angle) {
    BondSetting setting = setting_of(2, true, angle);
    setting.lattice->surface_correction = SurfaceCorrection::none;
    return pull_of(setting).peak(Loading::tension, linear(4.0)).mean;
  };
  EXPECT_NEAR(at_angle(18.0) / at_angle(0.0), 1.0, 1e-8);
}

/// Triangles and tetrahedra count: Young's modulus along an axis is the lattice's.
TEST(BulkPull, OfCpdHasTheModuliOfItsLattice) {
  for (const int dimension : {2, 3}) {
    const Kernel kernel{dimension, 2.015, dimension == 2 ? 0.7 : 1.0};
    const CpdStiffness stiffness = lattice_stiffness(kernel, 1.0);
    const CpdConstants constants = stiffness.constants(lame_moduli(2.5, 0.4, dimension), 0.0);
    const auto [c11, c12, c44] = stiffness.elasticity(constants);
    const double young =
        dimension == 2 ? c11 - c12 * c12 / c11 : c11 - 2.0 * c12 * c12 / (c11 + c12);
    const BulkPull pull(kernel, 1.0, constants);
    const DirectionalSpread onset = pull.onset(Loading::tension, 1e-3);
    EXPECT_LE(onset.least, young * 1e-3 * (1.0 + 1e-10)) << dimension;
    EXPECT_GE(onset.most, young * 1e-3 * (1.0 - 1e-10)) << dimension;
    // Under equal tension all bonds of a plane have the same stretch.
    if (dimension == 2) {
      EXPECT_NEAR(pull.onset(Loading::biaxial, 1e-3).mean / ((c11 + c12) * 1e-3), 1.0, 1e-10);
    }
    EXPECT_GT(pull.peak(Loading::tension, {ForceEnvelope{1e-3, 4e-3}}).mean, onset.mean);
  }
}

}  // namespace
}  // namespace peristat
