// Bonds that start to fail where the stress of their points reaches a strength surface.
#include "assembly/terms/failure/strength_onsets.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "src/potentials/critical_of_work.hpp"
#include "tests/release_body.hpp"

namespace peristat {
namespace {

using tests::BoxSetting;
using tests::ReleaseBody;

constexpr double modulus = 2.0, tension = 1e-4, compression = 16.7 * tension;  // of ReleaseBody
const AnyBondLaw tough{ForceEnvelope{0.4 * tension / modulus, 40000.0 * tension / modulus}};

std::shared_ptr<const StrengthOnsets> onsets_of(StrengthCriterion criterion, double nu, int d,
                                                std::array<double, 2> factor = {0.01, 1e3}) {
  const MaterialStrength strength{{criterion, tension, compression},
                                  d,
                                  lame_constants(modulus, nu, d, PlaneState::stress),
                                  0.0,
                                  factor};
  return std::make_shared<const StrengthOnsets>(
      std::vector<std::optional<PointStrength>>{PointStrength{strength}},
      std::vector<std::uint8_t>(), std::vector<double>());
}

/// Displacements of a homogeneous stress along turned axes.
std::vector<double> stressed(const ReleaseBody& body, double nu,
                             const std::array<double, 3>& stresses, double turn) {
  const int d = body.points.dimension;
  const double trace = stresses[0] + stresses[1] + (d == 3 ? stresses[2] : 0.0);
  const double c = std::cos(turn), s = std::sin(turn);
  const std::array<std::array<double, 3>, 3> axes{{{c, s, 0}, {-s, c, 0}, {0, 0, 1}}};
  std::vector<double> u(body.dofs(), 0.0);
  for (Index i = 0; i < Index(body.points.volume.size()); ++i) {
    for (int k = 0; k < d; ++k) {
      const auto& n = axes[std::size_t(k)];
      const double strain = ((1.0 + nu) * stresses[std::size_t(k)] - nu * trace) / modulus;
      double along = 0.0;
      for (int a = 0; a < d; ++a)
        along += n[std::size_t(a)] * body.points.reference[std::size_t(i * d + a)];
      for (int a = 0; a < d; ++a) u[std::size_t(i * d + a)] += strain * along * n[std::size_t(a)];
    }
  }
  return u;
}

class StrengthOfPoisson
    : public ::testing::TestWithParam<std::tuple<StrengthCriterion, double, bool>> {};
INSTANTIATE_TEST_SUITE_P(Surfaces, StrengthOfPoisson,
                         ::testing::Combine(::testing::Values(StrengthCriterion::rankine,
                                                              StrengthCriterion::drucker_prager,
                                                              StrengthCriterion::mohr_coulomb),
                                            ::testing::Values(0.0, 0.2, 1.0 / 3.0, 0.45),
                                            ::testing::Bool()));

/// The first bond of a body under a homogeneous stress starts on the surface: 36 ratios of stresses
/// along turned axes, lattices and clouds, states and bonds.
TEST_P(StrengthOfPoisson, IsReachedOnTheSurface) {
  const auto [criterion, nu, is_cloud] = GetParam();
  BoxSetting box = tests::small_box(2);
  box.perturbation = is_cloud ? 0.2 : 0.0;
  const ReleaseBody body(box, nu, tough, onsets_of(criterion, nu, 2));
  const StrengthSurface surface{criterion, tension, compression};
  for (const Model* model : {&body.model, &body.bond_model}) {
    Assembler assembler(body.points, *model, 1);
    int reached = 0;
    for (int k = 0; k < 36; ++k) {
      const double angle = 2.0 * std::numbers::pi * (k + 0.3) / 36.0;
      const std::array<double, 3> unit{std::cos(angle), std::sin(angle), 0.0};
      const double rho = surface.utilisation(unit);
      if (!(rho > 0.0)) continue;  // no stress of this ratio is a strength
      const double scale = 0.7 / rho;
      const std::vector<double> u =
          stressed(body, nu, {scale * unit[0], scale * unit[1], 0.0}, 0.4);
      const double found = assembler.growth({u, assembler.initial_history()}).utilisation;
      if (found == 0.0) continue;  // the stress drives no bond: compression prevails
      EXPECT_NEAR(found, 0.7, 0.7e-12) << angle << (model == &body.model ? " states" : " bonds");
      ++reached;
    }
    EXPECT_GE(reached, 22);
  }
}

TEST(StrengthOnsets, ReachesTheSurfaceInSpace) {
  const double nu = 0.2;
  const ReleaseBody body(tests::small_box(3), nu, tough,
                         onsets_of(StrengthCriterion::drucker_prager, nu, 3));
  Assembler assembler(body.points, body.model, 2);
  const StrengthSurface surface{StrengthCriterion::drucker_prager, tension, compression};
  for (const std::array<double, 3>& unit :
       {std::array{1.0, 0.0, 0.0}, std::array{1.0, 1.0, 1.0}, std::array{0.0, -1.0, 1.0},
        std::array{-0.3, 1.0, 0.4}}) {
    const double scale = 1.0 / surface.utilisation(unit);
    const std::vector<double> u =
        stressed(body, nu, {scale * unit[0], scale * unit[1], scale * unit[2]}, 0.7);
    EXPECT_NEAR(assembler.growth({u, assembler.initial_history()}).utilisation, 1.0, 1e-12);
  }
}

/// Another stress moves the onset of bonds that have not started, and of no other one.
TEST(StrengthOnsets, AreFrozenOnceABondStarts) {
  const double nu = 0.2;
  const ReleaseBody body(tests::small_box(2), nu, tough,
                         onsets_of(StrengthCriterion::drucker_prager, nu, 2));
  Assembler assembler(body.points, body.model, 1);
  History history = assembler.initial_history();
  const auto array_of = [&](int k) {
    const std::span<const double> all = history.of(0);
    const std::span<const double> part = all.subspan(std::size_t(k) * all.size() / 3);
    return std::vector<double>(part.begin(), part.begin() + body.model.bonds().count());
  };
  assembler.commit(stressed(body, nu, {1.1 * tension, 0.0, 0.0}, 0.0), history);
  const std::vector<double> largest = array_of(0), onset = array_of(1), critical = array_of(2);
  assembler.commit(stressed(body, nu, {0.2 * tension, 0.3 * tension, 0.0}, 0.0), history);
  const std::vector<double> later = array_of(1), critical_later = array_of(2);
  int started = 0, moved = 0;
  for (std::size_t b = 0; b < largest.size(); ++b) {
    if (largest[b] == 0.0) {
      moved += later[b] != onset[b];
      continue;
    }
    ++started;
    EXPECT_EQ(later[b], onset[b]);
    EXPECT_EQ(critical_later[b], critical[b]);
    EXPECT_GT(largest[b], onset[b]);
  }
  EXPECT_GT(started, 20);
  EXPECT_GT(moved, 20);
}

/// A tear takes the work of the law, whatever stress it comes from.
TEST(StrengthOnsets, LeaveTheFractureEnergy) {
  const double nu = 0.2, work = tough.work(Harmonic{1.0}, tough.critical());
  for (const auto& onsets : {onsets_of(StrengthCriterion::drucker_prager, nu, 2),
                             onsets_of(StrengthCriterion::rankine, nu, 2, {0.9, 1.1})}) {
    const ReleaseBody body(tests::small_box(2), nu, tough, onsets);
    const double x = 0.42;
    for (const Model* model : {&body.model, &body.bond_model}) {
      Assembler assembler(body.points, *model, 1);
      History history = assembler.initial_history();
      assembler.commit(stressed(body, nu, {0.5 * tension, 0.4 * tension, 0.0}, 0.3), history);
      for (const double opening : {1e-3, 1e-2, 0.1, 10.0}) {
        assembler.commit(body.torn(x, opening), history);
      }
      std::vector<double> damage(body.points.volume.size());
      const double taken = assembler.assess(history, {}, damage).dissipated_energy;
      EXPECT_NEAR(taken / body.taken_across(x, work), 1.0, 1e-12);
    }
  }
}

TEST(StrengthSurface, HasItsStrengths) {
  const double ft = 3.0, fc = 50.0, fb = 2 * fc * ft / (3 * fc - ft),
               fs = 2 * fc * ft / (std::numbers::sqrt3 * (fc + ft));
  const StrengthSurface prager{StrengthCriterion::drucker_prager, ft, fc},
      coulomb{StrengthCriterion::mohr_coulomb, ft, fc}, rankine{StrengthCriterion::rankine, ft, 0};
  for (const auto& surface : {prager, coulomb, rankine}) {
    EXPECT_NEAR(surface.utilisation({0, ft, 0}), 1.0, 1e-15);
    EXPECT_NEAR(surface.utilisation({0, 2 * ft, -4}), 2 * surface.utilisation({-2, 0, ft}), 1e-14);
  }
  for (const auto& surface : {prager, coulomb}) {
    EXPECT_NEAR(surface.utilisation({0, 0, -fc}), 1.0, 1e-14);
  }
  EXPECT_NEAR(prager.utilisation({fb, 0, fb}), 1.0, 1e-14);
  EXPECT_NEAR(prager.utilisation({-fs, 0, fs}), 1.0, 1e-14);
  EXPECT_LT(prager.utilisation({-fc, -fc, -fc}), 0.0);
  EXPECT_EQ(rankine.utilisation({-fc, -1.0, 0}), 0.0);
  EXPECT_NEAR(coulomb.utilisation({1.0, 0.0, -4.0}), 1.0 / ft + 4.0 / fc, 1e-15);
  EXPECT_NEAR(compressive_strength(ft, fb), fc, 1e-12 * fc);
  EXPECT_LT(compressive_strength(ft, 0.6 * ft), 0.0);
}

TEST(CriticalOfWork, KeepsTheWork) {
  const double s = 1e-4;
  for (const AnyBondLaw& law :
       {AnyBondLaw{ForceEnvelope{s, 7 * s}}, AnyBondLaw{ForceEnvelope{s, 7 * s, 4.0}},
        AnyBondLaw{ForceEnvelope{s, 7 * s, 0.0, 0.3, 0.5}},
        AnyBondLaw{TanhDegradation{s, 7 * s, 3}},
        AnyBondLaw{TanhDegradation::continuous(s, 7 * s, 3)},
        AnyBondLaw{OpeningLaw{s, 8 * s, OpeningCurve::bilinear}},
        AnyBondLaw{OpeningLaw{s, 8 * s, OpeningCurve::cornelissen}}}) {
    const double work = law.work(Harmonic{1.0}, law.critical());
    const double most = law.largest_onset(work) / s;
    EXPECT_LE(most, std::sqrt(2.0 * work) / s * (1.0 + 1e-15));
    EXPECT_NEAR(critical_of_work(law, s, work, 3 * s), law.critical(), 1e-13 * law.critical());
    for (const double chi : {0.1, 0.5, 0.99, 1.01, 0.99 * most, most}) {
      const AnyBondLaw moved = law.between(chi * s, critical_of_work(law, chi * s, work, 7 * s));
      EXPECT_NEAR(moved.work(Harmonic{1.0}, moved.critical()) / work, 1.0, 1e-11) << chi;
      EXPECT_GT(moved.critical(), moved.onset());
    }
  }
}

}  // namespace
}  // namespace peristat
