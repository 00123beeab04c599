// Damage of states by what bonds release: exact drops of energy, tears, and the bond model's limit.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/terms/states/state_term.hpp"
#include "src/materials/lame_constants.hpp"
#include "src/potentials/potential.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxSetting;
using tests::distance;
using tests::norm;
using tests::Random;

constexpr double youngs_modulus = 2.0;

/// A box of states whose bonds take kappa r^2 (q_i + q_j) times the work of the law.
struct ReleaseBody {
  Points points;
  std::shared_ptr<StateTerm> term;
  Model model, bond_model;

  ReleaseBody(const BoxSetting& box, double poisson_ratio, const BondPotential& potential)
      : points(tests::box_points(box)) {
    BondSetting setting = tests::bond_setting(box);
    setting.influence = [](double) { return 1.0; };  // K = 1 / r
    Bonds bonds = make_bonds(points, SurfaceCorrection::none, setting, 1);
    const LamePair constants =
        lame_constants(youngs_modulus, poisson_ratio, box.dimension, PlaneState::stress);
    StateShares shares;
    shares.whole = bonds.kind;
    shares.moment = moments_of(points, bonds);
    shares.constants.assign(points.volume.size(), constants);
    const int d = box.dimension;
    const auto q = [&](Index point) {
      const auto i = std::size_t(point);
      return points.volume[i] * d * (d + 2) * constants.mu / shares.moment[i];
    };
    bonds.set_weights([&](Index i, Offset bond) {
      return shares.whole[bond].weight * (q(i) + q(bonds.partner[bond]));
    });
    bond_model = Model(bonds, potential);
    term = std::make_shared<StateTerm>(std::make_shared<const Bonds>(std::move(bonds)), potential,
                                       std::vector<char>(), std::move(shares),
                                       StateRules{Extension::finite, DamageDrive::release}, 1);
    model = Model(std::shared_ptr<Term>(term));
  }

  [[nodiscard]] std::size_t dofs() const { return points.reference.size(); }

  /// Moves the points beyond x apart.
  [[nodiscard]] std::vector<double> torn(double x, double opening) const {
    const auto d = std::size_t(points.dimension);
    std::vector<double> u(dofs(), 0.0);
    for (Index i = 0; i < points.count(); ++i) {
      if (points.position(i)[0] >= x) u[std::size_t(i) * d] = opening;
    }
    return u;
  }

  /// sum over the bonds across x of what they take in all.
  [[nodiscard]] double taken_across(double x, double work_of_law) const {
    double sum = 0.0;
    tests::for_each_bond(model.bonds(), [&](Index i, Index j, Offset bond) {
      if ((points.position(i)[0] < x) == (points.position(j)[0] < x)) return;
      sum += model.bonds().weight(bond) * model.bonds().length(bond) * work_of_law;
    });
    return sum;
  }
};

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

}  // namespace
}  // namespace peristat
