// Damage of states by what bonds release: exact drops of energy, tears, and the bond model's limit.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/borne_stretches.hpp"
#include "src/potentials/make_saw_tooth.hpp"
#include "src/potentials/potential.hpp"
#include "tests/release_body.hpp"

namespace peristat {
namespace {

using tests::BoxSetting;
using tests::distance;
using tests::norm;
using tests::Random;
using tests::ReleaseBody;

BondPotential brittle(double critical) {
  return Degraded<CriticalStretch>{1.0, CriticalStretch{critical}};
}

double dissipated(Assembler& assembler, const History& history) {
  std::vector<double> damage(std::size_t(assembler.points().count()));
  return assembler.assess(history, {}, damage).dissipated_energy;
}

class ReleaseOfPoisson : public ::testing::TestWithParam<std::tuple<int, double>> {};
INSTANTIATE_TEST_SUITE_P(Ratios, ReleaseOfPoisson,
                         ::testing::Combine(::testing::Values(2, 3),
                                            ::testing::Values(-0.2, 0.0, 0.2, 1.0 / 3.0, 0.45)));

/// The first bond to break sets free just what its equivalent stretch says.
TEST_P(ReleaseOfPoisson, UtilisationIsTheDropOfEnergy) {
  const auto [d, nu] = GetParam();
  BoxSetting box = tests::small_box(d);
  box.perturbation = 0.2;
  const double any = 1e-3;
  const ReleaseBody trial(box, nu, brittle(any));
  const std::vector<double> u = Random(5).vector(trial.dofs(), 0.01);
  Assembler of_trial(trial.points, trial.model, 1);
  const double most = of_trial.growth({u, of_trial.initial_history()}).utilisation * any;
  const double critical = most * (1.0 - 1e-6);  // just the first one

  const ReleaseBody body(box, nu, brittle(critical));
  Assembler assembler(body.points, body.model, 1);
  History history = assembler.initial_history();
  const double before = assembler.energy({u, history}).energy;
  const DamageGrowth growth = assembler.growth({u, history});
  ASSERT_EQ(growth.breaking, 1);
  const Evaluation after = assembler.commit(u, history, {});
  EXPECT_EQ(after.growth.breaking, 1);
  EXPECT_TRUE(after.moves_equilibrium);
  const double drop = before - after.energy, taken = dissipated(assembler, history);
  EXPECT_GT(taken, 0.0);
  EXPECT_NEAR(drop, growth.utilisation * growth.utilisation * taken, 1e-9 * drop);
}

/// Y is the derivative of the energy by the integrity of a bond: small losses of a softening bond.
TEST_P(ReleaseOfPoisson, EquivalentStretchIsTheDerivative) {
  const auto [d, nu] = GetParam();
  BoxSetting box = tests::small_box(d);
  box.perturbation = 0.2;
  const ReleaseBody body(box, nu, Degraded<ForceEnvelope>{1.0, ForceEnvelope{1e-3, 1.0}});
  Assembler assembler(body.points, body.model, 1);
  const std::vector<double> u = Random(6).vector(body.dofs(), 0.01);
  const Bonds& bonds = body.model.bonds();
  // The largest of all stretched bonds, each by its energy with integrities 1 and a little less.
  const double driving = assembler.growth({u, assembler.initial_history()}).utilisation * 1e-3;
  double largest = 0.0;
  tests::for_each_bond(bonds, [&](Index i, Index j, Offset bond) {
    double before = 0.0, now = 0.0;
    for (std::size_t c = 0; c < std::size_t(d); ++c) {
      const std::size_t from = std::size_t(i * d) + c, to = std::size_t(j * d) + c;
      const double arm = body.points.reference[to] - body.points.reference[from];
      before += arm * arm;
      now += std::pow(arm + u[to] - u[from], 2);
    }
    if (now <= before) return;
    const auto energy = [&](double stretch) {
      std::vector<double> stretches(std::size_t(bonds.count()), 0.0);
      stretches[std::size_t(bond)] = stretch;
      return assembler.energy({u, assembler.history_of(stretches)}).energy;
    };
    const double small = 1.0005e-3;
    const double lost = 1.0 - ForceEnvelope{1e-3, 1.0}.integrity(small);
    const double release = (energy(0.0) - energy(small)) / lost;
    const double squared = 2.0 * release / (bonds.weight(bond) * bonds.length(bond));
    largest = std::max(largest, std::sqrt(std::max(squared, 0.0)));
  });
  EXPECT_NEAR(largest, driving, 1e-3 * driving);  // of first order in the loss, 5e-4
}

/// Whatever nu is, a tear takes what its bonds take, and no commit sets less free than it takes.
TEST_P(ReleaseOfPoisson, ATearTakesWhatItsBondsTake) {
  const auto [d, nu] = GetParam();
  for (const bool softens : {false, true}) {
    BoxSetting box = tests::small_box(d);
    box.perturbation = 0.1;
    const double critical = 0.02;
    const BondPotential law =
        softens
            ? BondPotential(Degraded<ForceEnvelope>{1.0, ForceEnvelope{0.5 * critical, critical}})
            : brittle(critical);
    const ReleaseBody body(box, nu, law);
    Assembler assembler(body.points, body.model, 1);
    const double middle = 0.5 * box.extent[0] * box.spacing;
    const double work = softens ? 0.25 * critical * critical : 0.5 * critical * critical;
    const double expected = body.taken_across(middle, work);
    History history = assembler.initial_history();
    double taken = 0.0, drained = 0.0;
    const double last = 3.0 * box.spacing;  // stretches bonds along the plane, too
    for (int step = 1; step <= 100; ++step) {
      const std::vector<double> u = body.torn(middle, last * std::pow(1.08, step - 100));
      double before = assembler.energy({u, history}).energy;
      for (int pass = 0; pass < 200; ++pass) {  // at fixed displacements
        const Evaluation after = assembler.commit(u, history, {});
        if (!after.moves_equilibrium) break;
        const double now = dissipated(assembler, history);
        EXPECT_GE(before - after.energy, now - taken - 1e-13 * expected);
        drained += before - after.energy - (now - taken);
        taken = now;
        before = after.energy;
      }
      EXPECT_EQ(assembler.growth({u, history}).degrading, 0);
    }
    EXPECT_NEAR(taken, expected, 1e-12 * expected);
    EXPECT_GT(drained, 0.0);
  }
}

/// lambda = mu: the bond model, through a whole tear.
TEST(StateRelease, IsTheBondModelAtItsPoissonRatio) {
  for (const int d : {2, 3}) {
    BoxSetting box = tests::small_box(d);
    box.perturbation = 0.1;
    const ReleaseBody body(box, d == 2 ? 1.0 / 3.0 : 0.25, brittle(0.02));
    Assembler states(body.points, body.model, 1), bonds(body.points, body.bond_model, 1);
    History of_states = states.initial_history(), of_bonds = bonds.initial_history();
    const std::vector<double> disorder = Random(7).vector(body.dofs(), 2e-4);
    std::vector<double> one(body.dofs()), other(body.dofs());
    const double middle = 0.5 * box.extent[0] * box.spacing;
    Index broken = 0;
    for (int step = 1; step <= 20; ++step) {
      std::vector<double> u = body.torn(middle, 0.003 * box.spacing * step);
      for (std::size_t k = 0; k < u.size(); ++k) u[k] += disorder[k];
      const Evaluation a = states.commit(u, of_states, one), b = bonds.commit(u, of_bonds, other);
      EXPECT_EQ(a.growth.breaking, b.growth.breaking);
      EXPECT_NEAR(a.energy, b.energy, 1e-13 * b.energy);
      EXPECT_LT(distance(one, other), 1e-13 * norm(other));
      broken += a.growth.breaking;
    }
    EXPECT_GT(broken, 20);
    EXPECT_NEAR(dissipated(states, of_states), dissipated(bonds, of_bonds),
                1e-13 * dissipated(bonds, of_bonds));
  }
}

/// What is drained is the step of the opening: it tends to nothing as steps get smaller.
TEST(StateRelease, SmallerStepsDrainLess) {
  for (const double nu : {0.0, 0.45}) {
    BoxSetting box = tests::small_box(2);
    box.horizon_ratio = 3.015;
    const double critical = 0.02;
    std::vector<double> excess;
    for (const int steps : {50, 200, 800}) {
      const ReleaseBody body(box, nu,
                             Degraded<ForceEnvelope>{1.0, ForceEnvelope{0.5 * critical, critical}});
      Assembler assembler(body.points, body.model, 1);
      const double middle = 0.45 * box.extent[0] * box.spacing;
      History history = assembler.initial_history();
      double dropped = 0.0;
      for (int step = 1; step <= steps; ++step) {
        const std::vector<double> u =
            body.torn(middle, 1.1 * critical * box.spacing * box.horizon_ratio * step / steps);
        const double before = assembler.energy({u, history}).energy;
        while (assembler.commit(u, history, {}).moves_equilibrium) {
        }
        dropped += before - assembler.energy({u, history}).energy;
      }
      excess.push_back(dropped / dissipated(assembler, history) - 1.0);
    }
    EXPECT_LT(excess[0], 0.3);
    EXPECT_NEAR(excess[0] / excess[1], 4.0, 1.0);
    EXPECT_NEAR(excess[1] / excess[2], 4.0, 1.0);
  }
}

/// A body whose bonds are on different teeth of a saw-tooth, in a random state.
struct OnTeeth {
  ReleaseBody body;
  Assembler assembler;
  std::vector<double> u;
  History history;
  std::vector<double> borne;

  OnTeeth(int d, double nu, int threads = 1)
      : body(perturbed(d), nu,
             with_teeth(Degraded<ForceEnvelope>{1.0, ForceEnvelope{0.005, 0.02}}, 5)),
        assembler(body.points, body.model, threads),
        u(Random(8).vector(body.dofs(), 0.01)),
        history(assembler.initial_history()),
        borne(borne_stretches(body.model, history)) {
    for (int event = 0; event < 60; ++event) drop_some(3);
  }

  static BoxSetting perturbed(int d) {
    BoxSetting box = tests::small_box(d);
    box.perturbation = 0.2;
    return box;
  }
  [[nodiscard]] StateView at() const { return {u, history, Damage::held}; }
  [[nodiscard]] std::vector<UtilisedBond> utilised(double least) {
    return utilised_bonds(assembler, at(), borne, least);
  }
  void drop_some(std::size_t count) {
    std::vector<UtilisedBond> bonds = utilised(0.1);
    bonds.resize(std::min(bonds.size(), count));
    const BondDrops dropped = drop(assembler, at(), borne, bonds);
    history = assembler.history_of(dropped.histories);
    borne = dropped.borne;
  }
};

/// From tooth to tooth: a drop sets free the square of its utilisation times what its law takes.
TEST_P(ReleaseOfPoisson, DropsSetFreeWhatTheirUtilisationSays) {
  const auto [d, nu] = GetParam();
  OnTeeth state(d, nu);
  const double stored = state.assembler.energy(state.at()).energy;
  int whole = 0, damaged = 0;
  for (const UtilisedBond& bond : state.utilised(1e-6)) {
    const double before = bond_stretches(state.body.model, state.history)[std::size_t(bond.bond)];
    before == 0.0 ? ++whole : ++damaged;
    const std::vector<UtilisedBond> one{bond};
    const BondDrops dropped = drop(state.assembler, state.at(), state.borne, one);
    EXPECT_GT(dropped.dissipated, 0.0);
    EXPECT_NEAR(dropped.energy_lost, dropped.dissipated * std::pow(bond.utilisation, 2),
                1e-12 * stored);
    const History after = state.assembler.history_of(dropped.histories);
    EXPECT_NEAR(dissipated(state.assembler, after) - dissipated(state.assembler, state.history),
                dropped.dissipated, 1e-12 * stored);
  }
  EXPECT_GT(whole, 20);
  EXPECT_GT(damaged, 20);
}

/// All teeth of a bond take what its law takes in all.
TEST(StateRelease, TeethTakeWhatTheirLawTakes) {
  OnTeeth state(2, 0.45);
  const Bonds& bonds = state.body.model.bonds();
  for (const Offset bond : {Offset(3), Offset(40)}) {
    History history = state.assembler.initial_history();
    std::vector<double> borne = borne_stretches(state.body.model, history);
    double taken = 0.0;
    int teeth = 0;
    while (std::isfinite(borne[std::size_t(bond)])) {
      const std::vector<UtilisedBond> one{{bond, 0, 1.0, 0.0}};
      const BondDrops dropped = drop(state.assembler, {state.u, history, Damage::held}, borne, one);
      history = state.assembler.history_of(dropped.histories);
      borne = dropped.borne;
      taken += dropped.dissipated;
      ++teeth;
    }
    const double expected = bonds.weight(bond) * bonds.length(bond) * 0.5 * 0.005 * 0.02;
    EXPECT_NEAR(taken, expected, 1e-12 * expected);
    EXPECT_GT(teeth, 2);
  }
}

/// Along a line of stretches the square of the drive is the polynomial that it says, it is that of
/// the growth of damage, and hardly depends on threads.
TEST_P(ReleaseOfPoisson, DrivesAlongALine) {
  const auto [d, nu] = GetParam();
  OnTeeth state(d, nu), on_threads(d, nu, 3);
  const auto count = std::size_t(state.body.model.bonds().count());
  const std::vector<double> s = Random(3).vector(count, 0.01), rate = Random(4).vector(count, 0.3);
  const auto drives = [&](OnTeeth& of, double step, bool moves) {
    std::vector<BondDrive> all(count);
    for (std::size_t b = 0; b < count; ++b) {
      all[b] = BondDrive::by_stretch(s[b] + step * rate[b], moves ? rate[b] : 0.0);
    }
    of.assembler.add_drive(of.at(), {}, all);
    return all;
  };
  const std::vector<BondDrive> line = drives(state, 0.0, true),
                               same = drives(on_threads, 0.0, true);
  for (const double step : {-0.3, 0.01, 0.2}) {
    const std::vector<BondDrive> there = drives(state, step, false);
    for (std::size_t b = 0; b < count; ++b) {
      const auto& c = line[b].squared;
      const double expected = c[0] + step * (c[1] + step * c[2]);
      EXPECT_NEAR(there[b].squared[0], expected, 1e-13);
      // Threads add up the dilatations in another order.
      for (std::size_t k = 0; k < c.size(); ++k) EXPECT_NEAR(c[k], same[b].squared[k], 1e-15);
    }
  }
  EXPECT_NEAR(largest_utilisation(state.assembler, state.at(), state.borne),
              state.assembler.growth(state.at()).utilisation, 1e-12);
}

/// The square of a drive, where its stretch is positive.
double square_at(const BondDrive& drive, double step) {
  if (!(drive.stretch + step * drive.rate > 0.0)) return 0.0;
  return drive.squared[0] + step * (drive.squared[1] + step * drive.squared[2]);
}

TEST(BondDrives, AreWithinTheirLimitsInTheRange) {
  Random random(2);
  int beyond = 0, both_sides = 0;
  for (int k = 0; k < 2000; ++k) {
    BondDrive drive{random.number(), k % 5 == 0 ? 0.0 : random.number()};
    for (double& c : drive.squared) c = random.number();
    if (k % 3 == 0) drive.squared[2] = 0.0;
    const double limit = 0.5;
    const auto is_beyond = [&](double step) { return square_at(drive, step) > limit * limit; };
    const AdmissibleRange range = admissible_range(drive, limit);
    SCOPED_TRACE(k);
    if (!is_beyond(0.0)) {
      ASSERT_LE(range.low, 0.0);
      ASSERT_GE(range.high, 0.0);
      both_sides += std::isfinite(range.low) && std::isfinite(range.high);
    } else if (range.low <= range.high) {
      ++beyond;
      ASSERT_TRUE(range.low > 0.0 || range.high < 0.0);
      if (drive.squared[1] > 0.0 && range.low > 0.0) {
        for (double step = 0.0; step > -50.0; step -= 0.1) EXPECT_TRUE(is_beyond(step));
      }
    }
    for (const double end : {range.low, range.high}) {
      if (std::isinf(end)) continue;
      const double small = 1e-7 * (1.0 + std::abs(end));
      EXPECT_NE(is_beyond(end - small), is_beyond(end + small));
    }
    const double from = std::max(range.low, -50.0), to = std::min(range.high, 50.0);
    const double nearest = std::abs(from) < std::abs(to) ? from : to;
    for (int part = 1; part < 100; ++part) {
      const double step = from + (to - from) * 0.01 * part;
      if (!is_beyond(0.0)) {
        EXPECT_FALSE(is_beyond(step));
      }
      // Nothing nearer on the way.
      if (is_beyond(0.0) && range.low <= range.high) {
        EXPECT_TRUE(is_beyond(0.01 * part * nearest));
      }
    }
  }
  EXPECT_GT(beyond, 100);
  EXPECT_GT(both_sides, 20);
}

}  // namespace
}  // namespace peristat
