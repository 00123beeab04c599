#include "assembly/borne_stretches.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/terms/damage.hpp"
#include "src/potentials/make_saw_tooth.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

constexpr double onset = 0.01, critical = 0.03;

BondPotential toothed(double micromodulus) {
  return with_teeth(Degraded<ForceEnvelope>{micromodulus, {onset, critical}}, 6);
}

/// A box whose bonds have lost some of their teeth.
struct Torn {
  tests::BoxSetting setting;
  tests::BoxBody body;
  Assembler assembler;
  std::vector<double> histories;
  History history;
  std::vector<double> borne, displacement, rate;

  Torn(int dimension, int threads)
      : setting(of(dimension)),
        body(tests::box_points(setting), setting),
        assembler(body.points, body.model, threads) {
    tests::Random random(3);
    history = assembler.initial_history();
    for (const double largest : bond_stretches(body.model, history)) histories.push_back(largest);
    borne = borne_stretches(body.model, history);
    displacement = random.vector(body.dofs(), 0.02 * setting.spacing);
    rate = random.vector(body.dofs(), 0.1 * setting.spacing);
    for (int event = 0; event < 40; ++event) tear();
  }

  static tests::BoxSetting of(int dimension) {
    tests::BoxSetting box = tests::small_box(dimension);
    box.potential = toothed;
    return box;
  }

  [[nodiscard]] StateView at() const { return {displacement, history, Damage::held}; }

  BondDrops tear() {
    auto most = utilised_bonds(assembler, at(), borne, 0.5);
    most.resize(std::min<std::size_t>(most.size(), 3));
    BondDrops dropped = drop(assembler, at(), borne, most);
    history = assembler.history_of(dropped.histories);
    borne = dropped.borne;
    return dropped;
  }

  [[nodiscard]] double stretch(Index i, Index j, const std::vector<double>& u) const {
    double before = 0.0, now = 0.0;
    const int d = setting.dimension;
    for (int c = 0; c < d; ++c) {
      const std::size_t a = std::size_t(i * d + c), b = std::size_t(j * d + c);
      const double arm = body.points.reference[b] - body.points.reference[a];
      before += arm * arm;
      now += (arm + u[b] - u[a]) * (arm + u[b] - u[a]);
    }
    return std::sqrt(now / before) - 1.0;
  }
  [[nodiscard]] std::vector<double> moved(double way) const {
    std::vector<double> u = displacement;
    for (std::size_t k = 0; k < u.size(); ++k) u[k] += way * rate[k];
    return u;
  }
};

TEST(BorneStretches, AreTheStrengthsOfTheSecants) {
  const Torn torn(2, 1);
  const auto law = std::get<Degraded<SawTooth>>(toothed(1.0)).law;
  for (std::size_t bond = 0; bond < torn.borne.size(); ++bond) {
    const double largest = bond_stretches(torn.body.model, torn.history)[bond];
    if (largest == law.critical()) {
      EXPECT_TRUE(std::isinf(torn.borne[bond]));
    } else {
      EXPECT_EQ(torn.borne[bond], largest == 0.0 ? law.onset() : largest);
    }
    EXPECT_EQ(torn.borne[bond], borne_stretches(torn.body.model, torn.history)[bond]);
  }
  EXPECT_TRUE(fails_by_steps(torn.body.model));
}

TEST(BorneStretches, ADropTakesWhatTheEnergyLoses) {
  Torn torn(2, 2);
  std::vector<double> damage(std::size_t(torn.body.points.count()));
  for (int event = 0; event < 5; ++event) {
    const double stored = torn.assembler.energy(torn.at()).energy;
    const double dissipated =
        assess_damage(torn.body.model, torn.history, {}, damage).dissipated_energy;
    const BondDrops dropped = torn.tear();
    ASSERT_GT(dropped.stiffness.size(), 0u);
    EXPECT_NEAR(stored - torn.assembler.energy(torn.at()).energy, dropped.energy_lost,
                1e-13 * stored);
    const double after = assess_damage(torn.body.model, torn.history, {}, damage).dissipated_energy;
    EXPECT_NEAR(after - dissipated, dropped.dissipated, 1e-12 * after);
  }
}

TEST(BorneStretches, TheAdmissibleRangeIsThatOfEveryBond) {
  for (const int dimension : {1, 2, 3}) {
    for (const int threads : {1, 3}) {
      SCOPED_TRACE(std::to_string(dimension) + "D, " + std::to_string(threads));
      Torn torn(dimension, threads);
      const double h = 1e-6, share = 0.9;
      double low = -1e300, high = 1e300, most = 0.0;
      const std::vector<double> ahead = torn.moved(h), behind = torn.moved(-h);
      tests::for_each_bond(torn.body.model.bonds(), [&](Index i, Index j, Offset bond) {
        const double strength = torn.borne[std::size_t(bond)];
        if (std::isinf(strength)) return;
        const double s = torn.stretch(i, j, torn.displacement);
        const double speed = (torn.stretch(i, j, ahead) - torn.stretch(i, j, behind)) / (2.0 * h);
        const double way = (share * strength - s) / speed;
        if (speed > 0.0) high = std::min(high, way);
        if (speed < 0.0) low = std::max(low, way);
        most = std::max(most, s / strength);
      });
      const AdmissibleRange range =
          admissible_range(torn.assembler, torn.at(), torn.borne, torn.rate, {}, share);
      EXPECT_NEAR(range.low, low, 1e-5 * std::abs(low));
      EXPECT_NEAR(range.high, high, 1e-5 * std::abs(high));
      EXPECT_NEAR(range.utilisation, most, 1e-10);
      EXPECT_NEAR(largest_utilisation(torn.assembler, torn.at(), torn.borne), most, 1e-10);
    }
  }
}

TEST(BorneStretches, ThatAreNoNumberAreNotListed) {
  Torn torn(2, 1);
  const auto before = utilised_bonds(torn.assembler, torn.at(), torn.borne, 0.1);
  ASSERT_GT(before.size(), 10u);
  const Index lost = before.front().first_point;
  torn.displacement[std::size_t(lost) * 2] = std::numeric_limits<double>::quiet_NaN();
  const auto after = utilised_bonds(torn.assembler, torn.at(), torn.borne, 0.1);
  EXPECT_GT(after.size(), 0u);
  EXPECT_LT(after.size(), before.size());
  for (const UtilisedBond& one : after) EXPECT_GE(one.utilisation, 0.1);
}

TEST(BorneStretches, TheMostUtilisedComeFirst) {
  Torn one(3, 1), three(3, 3);
  const auto first = utilised_bonds(one.assembler, one.at(), one.borne, 0.1);
  const auto again = utilised_bonds(three.assembler, three.at(), three.borne, 0.1);
  ASSERT_EQ(first.size(), again.size());
  ASSERT_GT(first.size(), 10u);
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_EQ(first[k].bond, again[k].bond);
    EXPECT_GE(first[k > 0 ? k - 1 : 0].utilisation, first[k].utilisation);
    EXPECT_NEAR(first[k].utilisation * one.borne[std::size_t(first[k].bond)], first[k].stretch,
                1e-15);
  }
}

}  // namespace
}  // namespace peristat
