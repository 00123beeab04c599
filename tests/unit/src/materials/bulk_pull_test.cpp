#include "src/materials/bulk_pull.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "src/materials/cpd_constants.hpp"
#include "src/materials/lame_constants.hpp"

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

AnyLaw brittle(double stretch) { return {CriticalStretch{stretch}}; }

AnyLaw linear(double critical) { return {ForceEnvelope{1.0, critical}}; }

TEST(BulkPull, OfABarIsTheLargestForceOfItsBonds) {
  const BulkPull bar = pull_of(setting_of(1, false));
  const ForceEnvelope blended{1.0, 8.0, 0.0, 0.3, 0.5};
  EXPECT_NEAR(bar.peak(Loading::tension, {blended}).mean / blended.peak_force(), 1.0, 1e-9);
  EXPECT_NEAR(bar.onset(Loading::tension, brittle(2.0)).mean, 2.0, 1e-14);
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
    EXPECT_NEAR(pull.onset(Loading::tension, brittle(1.0)).mean, 1.0, fan);
    EXPECT_NEAR(pull.onset(Loading::biaxial, brittle(1.0)).mean * (1.0 - nu), 1.0, fan);
    EXPECT_NEAR(pull.onset(Loading::shear, brittle(1.0)).mean * (1.0 + nu), 1.0, fan);
    EXPECT_NEAR(pull.onset(Loading::compression, brittle(1.0)).mean * nu, 1.0, 4.0 * fan);
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

BondSetting states_in(int dimension, PlaneState plane, bool has_lattice) {
  BondSetting setting{{dimension, ratio, 1.0}, plane};
  setting.influence = [](double) { return 1.0; };
  if (has_lattice) setting.lattice = {Spacing(1.0)};
  return setting;
}

/// Of Young's modulus 1.
BulkPull pull_of_states(int dimension, double nu, PlaneState plane, bool has_lattice = true) {
  const BondSetting setting = states_in(dimension, plane, has_lattice);
  const auto [lambda, mu] = lame_constants(1.0, nu, dimension, plane);
  const double moment = has_lattice ? BulkBonds(setting).moment(1) : setting.moment(1);
  return {setting, 2.0 * dimension * (dimension + 2) * mu / moment, lambda / mu};
}

TEST(BulkPullOfStates, IsThatOfTheReference) {
  struct Known {
    int dimension;
    double nu;
    PlaneState plane;
    double brittle, soft;
  };
  // tests/reference/states_pull.py, StatePull.strength with step = 2e-3, of whose order the second
  // is.
  for (const auto& [dimension, nu, plane, brittle_strength, soft] :
       std::vector<Known>{{2, 0.0, PlaneState::stress, 1.4123584, 1.5355732},
                          {2, 0.2, PlaneState::stress, 1.1308808, 1.2265465},
                          {2, 0.45, PlaneState::stress, 0.9431268, 1.0131124},
                          {2, 0.3, PlaneState::strain, 1.0500415, 1.1291310},
                          {3, 0.2, PlaneState::stress, 1.0695929, 1.3363885}}) {
    const BulkPull pull = pull_of_states(dimension, nu, plane);
    EXPECT_NEAR(pull.peak(Loading::tension, brittle(1.0)).mean / brittle_strength, 1.0, 1e-6)
        << dimension << ' ' << nu;
    EXPECT_NEAR(pull.peak(Loading::tension, linear(4.0)).mean / soft, 1.0, 3e-4)
        << dimension << ' ' << nu;
  }
}

/// f_t = E s_0 / sqrt(1 + zeta (1 - nu)), f_b = E s_0 / ((1 - nu) sqrt(1 + 2 zeta)) and f_s = E s_0
/// / (1 + nu) in plane stress.
TEST(BulkPullOfStates, BeginsToSoftenAsTheReleaseOfTheContinuumHasIt) {
  for (const double nu : {-0.2, 0.0, 0.2, 0.45}) {
    const BulkPull pull = pull_of_states(2, nu, PlaneState::stress, false);
    const double zeta = 0.5 * (2.0 * nu / (1.0 - nu) - 1.0);
    EXPECT_NEAR(
        pull.onset(Loading::tension, brittle(1.0)).mean * std::sqrt(1.0 + zeta * (1.0 - nu)), 1.0,
        1e-3);
    EXPECT_NEAR(pull.onset(Loading::shear, brittle(1.0)).mean * (1.0 + nu), 1.0, 1e-3);
    if (nu <= 0.0) continue;
    EXPECT_NEAR(
        pull.onset(Loading::biaxial, brittle(1.0)).mean * (1.0 - nu) * std::sqrt(1.0 + 2.0 * zeta),
        1.0, 1e-3);
  }
}

TEST(BulkPullOfStates, IsThatOfBondsWhereLambdaIsMu) {
  for (const int dimension : {2, 3}) {
    const double nu = dimension == 2 ? 1.0 / 3.0 : 0.25;
    const BondSetting setting = states_in(dimension, PlaneState::stress, true);
    const double c =
        2.0 * dimension * (dimension + 2) / (2.0 * (1.0 + nu)) / BulkBonds(setting).moment(1);
    const BulkPull bonds(setting, c), states = pull_of_states(dimension, nu, PlaneState::stress);
    for (const Loading loading : {Loading::tension, Loading::biaxial, Loading::shear}) {
      for (const AnyLaw& law : {AnyLaw{CriticalStretch{1.0}}, linear(4.0)}) {
        EXPECT_NEAR(states.peak(loading, law).mean / bonds.peak(loading, law).mean, 1.0, 1e-9);
      }
      EXPECT_NEAR(
          states.onset(loading, brittle(1.0)).mean / bonds.onset(loading, brittle(1.0)).mean, 1.0,
          1e-13);
    }
  }
}

/// Equal tension in a plane of lambda = 0 releases nothing with one bond, and no stress does if
/// lambda is far below 0.
TEST(BulkPullOfStates, IsInfiniteWhereNoBondWouldReleaseEnergy) {
  const BulkPull plane = pull_of_states(2, 0.0, PlaneState::stress);
  EXPECT_TRUE(std::isinf(plane.peak(Loading::biaxial, linear(4.0)).mean));
  EXPECT_TRUE(std::isfinite(plane.peak(Loading::tension, linear(4.0)).mean));
  const BulkPull auxetic = pull_of_states(2, -0.5, PlaneState::stress);
  EXPECT_TRUE(std::isinf(auxetic.onset(Loading::tension, brittle(1.0)).mean));
  EXPECT_TRUE(std::isinf(auxetic.peak(Loading::tension, {CriticalStretch{1.0}}).mean));
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
    const DirectionalSpread onset = pull.onset(Loading::tension, brittle(1e-3));
    EXPECT_LE(onset.least, young * 1e-3 * (1.0 + 1e-10)) << dimension;
    EXPECT_GE(onset.most, young * 1e-3 * (1.0 - 1e-10)) << dimension;
    // Under equal tension all bonds of a plane have the same stretch.
    if (dimension == 2) {
      EXPECT_NEAR(pull.onset(Loading::biaxial, brittle(1e-3)).mean / ((c11 + c12) * 1e-3), 1.0,
                  1e-10);
    }
    EXPECT_GT(pull.peak(Loading::tension, {ForceEnvelope{1e-3, 4e-3}}).mean, onset.mean);
  }
}

}  // namespace
}  // namespace peristat
