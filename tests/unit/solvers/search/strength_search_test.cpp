#include "solvers/search/strength_search.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/search/linearisation.hpp"
#include "tests/problems.hpp"

namespace peristat {
namespace {

using tests::Problem;
using tests::support;

const IterationObserver nobody;
constexpr double critical = 0.05;

tests::BoxSetting brittle() {
  tests::BoxSetting box = tests::small_box(2);
  box.potential = [](double micromodulus) {
    return Degraded<CriticalStretch>{micromodulus, {critical}};
  };
  return box;
}

/// Counts substitutions.
struct CountingCholesky : Cholesky {
  int solves = 0;

  LinearOutcome solve(std::span<const double> b, std::span<double> x, double tolerance) override {
    ++solves;
    return Cholesky::solve(b, x, tolerance);
  }
};

/// A strip that is held on the left, drawn and turned on the right.
struct Drawn : Problem {
  CountingCholesky solver;
  UpdatedTangent updated;
  State state;
  std::vector<double> borne;

  explicit Drawn(const std::string& along = "0.2*load", const std::string& across = "0.1*load^2")
      : Problem(brittle(), {support("left", "0", "0"), support("right", along, across)}, {}, 2),
        updated(equilibrium, solver, tangent),
        state(at_rest()),
        borne(borne_stretches(body.model, state.history)) {
    EXPECT_EQ(analyze(solver), LinearOutcome::solved);
  }

  [[nodiscard]] StrengthStep step() const {
    StrengthStep made;
    made.borne = borne;
    made.range = {0.0, 1.0};
    made.stop = 1.0;
    return made;
  }
  [[nodiscard]] StrengthResult search(const StrengthStep& step) {
    return search_strength(equilibrium, updated, state, step, NewtonOptions(), nobody);
  }
  [[nodiscard]] double utilisation(const Trial& trial) {
    return largest_utilisation(assembler, trial.at(Damage::held), borne);
  }
  /// The state that a search by itself finds at the stage.
  [[nodiscard]] double distance_from_newton(const StrengthResult& found) {
    Cholesky own;
    EXPECT_EQ(analyze(own), LinearOutcome::solved);
    Tangent of_its_own(BlockPattern(body.model.bonds()), 2);
    NewtonOptions options;
    options.damage = Damage::held;
    State from = state;
    from.history = found.newton.state.history;
    const NewtonResult expected =
        newton(equilibrium, own, of_its_own, from, found.stage, options, nobody);
    EXPECT_EQ(expected.outcome, Outcome::converged);
    return tests::distance(found.newton.state.displacement, expected.state.displacement) /
           tests::norm(expected.state.displacement);
  }

  /// All bonds bear less.
  void weaken(double share) {
    for (double& strength : borne) strength *= share;
  }
  /// Some of the most stretched bonds break.
  void break_bonds(std::size_t count) {
    auto most = utilised_bonds(assembler, StateView(state, Damage::held), borne, 0.1);
    most.resize(count);
    const BondDrops dropped = drop(assembler, StateView(state, Damage::held), borne, most);
    state.history = assembler.history_of(dropped.histories);
    borne = dropped.borne;
    updated.lose(dropped.stiffness);
  }
};

TEST(StrengthSearch, EndsWhereTheFirstBondIsAtItsStrength) {
  Drawn drawn;
  const StrengthResult found = drawn.search(drawn.step());
  ASSERT_EQ(found.newton.outcome, Outcome::converged);
  ASSERT_EQ(found.end, StrengthEnd::at_strength);
  EXPECT_GT(found.stage, 0.05);
  EXPECT_LT(found.stage, 1.0);
  EXPECT_NEAR(drawn.utilisation(found.newton.state), share_at_strength, 1e-9);
  EXPECT_LE(found.newton.state.residual_norm, 1e-10 * found.newton.scale);
  EXPECT_LT(drawn.distance_from_newton(found), 1e-8);
}

TEST(StrengthSearch, ListsTheMostUtilisedBondsOfTheStateThatItFinds) {
  Drawn drawn;
  StrengthStep step = drawn.step();
  step.listed = 0.7;
  const StrengthResult found = drawn.search(step);
  ASSERT_EQ(found.end, StrengthEnd::at_strength);
  const auto expected = utilised_bonds(drawn.assembler, found.newton.state.at(Damage::held),
                                       drawn.borne, step.listed);
  ASSERT_GT(expected.size(), 2U);
  ASSERT_EQ(found.utilised.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(found.utilised[k].bond, expected[k].bond);
    EXPECT_EQ(found.utilised[k].utilisation, expected[k].utilisation);
  }
}

TEST(StrengthSearch, StopsBeforeIt) {
  Drawn drawn;
  StrengthStep step = drawn.step();
  step.stop = 0.05;
  const StrengthResult found = drawn.search(step);
  ASSERT_EQ(found.newton.outcome, Outcome::converged);
  EXPECT_EQ(found.end, StrengthEnd::at_stop);
  EXPECT_EQ(found.stage, 0.05);
  EXPECT_LT(drawn.utilisation(found.newton.state), 1.0);
  EXPECT_LT(drawn.distance_from_newton(found), 1e-8);
}

TEST(StrengthSearch, FindsTheSameStrengthFromAnywhereBelow) {
  double stage = 0.0;
  for (const double stop : {1.0, 0.01, 0.03, 0.06, 0.09}) {
    Drawn drawn;
    StrengthStep step = drawn.step();
    step.stop = stop;
    StrengthResult found = drawn.search(step);
    if (found.end == StrengthEnd::at_stop) {
      drawn.state = {found.newton.state.displacement, found.stage, drawn.state.history};
      found = drawn.search(drawn.step());
    }
    ASSERT_EQ(found.end, StrengthEnd::at_strength);
    if (stage == 0.0) stage = found.stage;
    EXPECT_NEAR(found.stage, stage, 1e-9);
  }
}

TEST(StrengthSearch, GoesDownWhereBondsAreAboveTheirStrength) {
  Drawn drawn;
  const StrengthResult first = drawn.search(drawn.step());
  drawn.state = {first.newton.state.displacement, first.stage, drawn.state.history};
  drawn.weaken(0.8);
  const StrengthResult found = drawn.search(drawn.step());
  ASSERT_EQ(found.newton.outcome, Outcome::converged);
  ASSERT_EQ(found.end, StrengthEnd::at_strength);
  EXPECT_FALSE(found.goes_up);
  EXPECT_LT(found.stage, 0.9 * first.stage);
  EXPECT_NEAR(drawn.utilisation(found.newton.state), share_at_strength, 1e-9);
  EXPECT_LT(drawn.distance_from_newton(found), 1e-8);
}

TEST(StrengthSearch, TellsWhereNoLoadOfTheRangeWillDo) {
  Drawn drawn;
  const StrengthResult first = drawn.search(drawn.step());
  drawn.state = {first.newton.state.displacement, first.stage, drawn.state.history};
  drawn.weaken(0.8);
  StrengthStep step = drawn.step();
  step.range.low = 0.95 * first.stage;
  EXPECT_EQ(drawn.search(step).end, StrengthEnd::inadmissible);
}

TEST(StrengthSearch, SettlesAtItsLoad) {
  Drawn drawn;
  const StrengthResult first = drawn.search(drawn.step());
  drawn.state = {first.newton.state.displacement, first.stage, drawn.state.history};
  drawn.break_bonds(3);
  StrengthStep step = drawn.step();
  step.settles = true;
  const StrengthResult found = drawn.search(step);
  ASSERT_EQ(found.newton.outcome, Outcome::converged);
  EXPECT_EQ(found.stage, first.stage);
  EXPECT_LE(found.newton.state.residual_norm, 1e-10 * found.newton.scale);
  EXPECT_GT(tests::distance(found.newton.state.displacement, first.newton.state.displacement),
            1e-6 * tests::norm(first.newton.state.displacement));
  EXPECT_LT(drawn.distance_from_newton(found), 1e-8);
}

TEST(StrengthSearch, SavesTheSubstitutionsThatTellNothingNew) {
  Drawn drawn;
  const StrengthResult first = drawn.search(drawn.step());
  drawn.state = {first.newton.state.displacement, first.stage, drawn.state.history};
  ASSERT_EQ(drawn.updated.refresh(drawn.state), LinearOutcome::solved);
  drawn.break_bonds(1);
  StrengthStep settling = drawn.step();
  settling.settles = true;
  // The answer to the force that the bond no longer bears follows from its column.
  drawn.solver.solves = 0;
  const StrengthResult settled = drawn.search(settling);
  ASSERT_EQ(settled.newton.outcome, Outcome::converged);
  EXPECT_EQ(drawn.solver.solves, settled.newton.iterations - 1);
}

TEST(StrengthSearch, DoesNotCorrectEquilibriaBeforeItsFirstStep) {
  Drawn drawn;
  ASSERT_EQ(drawn.updated.refresh(drawn.state), LinearOutcome::solved);
  StrengthStep step = drawn.step();
  step.stop = 0.03;
  drawn.solver.solves = 0;
  const StrengthResult found = drawn.search(step);
  ASSERT_EQ(found.newton.outcome, Outcome::converged);
  ASSERT_EQ(drawn.updated.refreshed(), 1);
  EXPECT_EQ(drawn.solver.solves, found.newton.iterations);  // one is that of the rate
}

TEST(StrengthSearch, LearnsFromTheSearchBefore) {
  Drawn drawn;
  const StrengthResult first = drawn.search(drawn.step());
  drawn.state = {first.newton.state.displacement, first.stage, drawn.state.history};
  ASSERT_EQ(drawn.updated.refresh(drawn.state), LinearOutcome::solved);
  for (double& component : drawn.state.displacement) component *= 1.02;
  StrengthStep step = drawn.step();
  step.settles = true;
  const TangentReference before = drawn.updated.reference();
  const int iterations = drawn.search(step).newton.iterations;
  EXPECT_GT(drawn.updated.reference().known.latest_first().size(), 1U);
  const StrengthResult again = drawn.search(step);
  EXPECT_LT(again.newton.iterations, iterations);
  EXPECT_LT(drawn.distance_from_newton(again), 1e-8);

  // What it has learned belongs to the tangent, and is restored with it.
  const TangentReference after = drawn.updated.reference();
  drawn.updated.become(before);
  EXPECT_EQ(drawn.search(step).newton.iterations, iterations);
  drawn.updated.become(after);
  EXPECT_EQ(drawn.search(step).newton.iterations, again.newton.iterations);
}

TEST(KnownCorrections, SolveWhatIsKnown) {
  // Corrections c change the residual of the matrix by -A c.
  const double a[3][3] = {{4.0, 1.0, 0.0}, {1.0, 3.0, -1.0}, {0.0, -1.0, 5.0}};
  const auto change = [&](const std::vector<double>& c) {
    std::vector<double> result(3);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) result[i] -= a[i][j] * c[j];
    }
    return result;
  };
  KnownCorrections known;
  const std::vector<double> solution{0.3, -0.7, 1.1};
  std::vector<double> residual = change(solution);
  for (double& entry : residual) entry = -entry;
  const double whole = tests::norm(residual);
  for (const std::vector<double>& c :
       {std::vector{1.0, 0.2, 0.0}, std::vector{0.0, 1.0, 0.5}, std::vector{0.1, 0.0, 1.0}}) {
    std::vector<double> rest = residual, found(3);
    known.take_off(rest, found);
    EXPECT_GT(tests::norm(rest), 1e-3 * whole);
    known.add(c, change(c));
  }
  std::vector<double> rest = residual, found(3);
  known.take_off(rest, found);
  EXPECT_LT(tests::norm(rest), 1e-5 * whole);  // single precision
  EXPECT_LT(tests::distance(found, solution), 1e-5);

  // The matrix loses k g g^T.
  const double k = 2.0, g[3] = {0.0, 0.6, -0.8};
  known.lose(k, std::vector<std::pair<Index, double>>{{1, g[1]}, {2, g[2]}});
  const double along = g[1] * solution[1] + g[2] * solution[2];
  for (int i = 0; i < 3; ++i) residual[std::size_t(i)] -= k * along * g[i];
  found.assign(3, 0.0);
  known.take_off(residual, found);
  EXPECT_LT(tests::norm(residual), 1e-5 * whole);
  EXPECT_LT(tests::distance(found, solution), 1e-5);
}

TEST(KnownCorrections, TheLatestCounts) {
  KnownCorrections known;
  known.add(std::vector{1.0, 0.0}, std::vector{-1.0, 0.0});
  known.add(std::vector{2.0, 0.0}, std::vector{-1.0, 0.0});  // the body has become softer
  std::vector<double> residual{1.0, 0.0}, found(2);
  known.take_off(residual, found);
  EXPECT_NEAR(found[0], 2.0, 1e-6);
}

TEST(UpdatedTangent, IsThatOfTheBodyWithoutWhatItHasLost) {
  // At rest a bond's stiffness is along its direction alone: nothing else is lost.
  Drawn drawn;
  ASSERT_EQ(drawn.updated.refresh(drawn.state), LinearOutcome::solved);
  const std::vector<double> force = tests::Random(5).vector(drawn.body.dofs());
  std::vector<double> whole, updated, anew, again;
  ASSERT_EQ(drawn.updated.solve(force, 1e-10, whole), LinearOutcome::solved);
  std::vector<UtilisedBond> some;
  tests::for_each_bond(drawn.body.model.bonds(), [&](Index i, Index, Offset bond) {
    if (bond % 9 == 4) some.push_back({bond, i, 1.0, 0.0});
  });
  const BondDrops dropped =
      drop(drawn.assembler, StateView(drawn.state, Damage::held), drawn.borne, some);
  drawn.state.history = drawn.assembler.history_of(dropped.histories);
  drawn.updated.lose(dropped.stiffness);
  ASSERT_TRUE(drawn.updated.is_there());
  ASSERT_EQ(drawn.updated.solve(force, 1e-10, updated), LinearOutcome::solved);

  const TangentReference reference = drawn.updated.reference();
  Tangent another(BlockPattern(drawn.body.model.bonds()), 2);
  Cholesky solver;
  ASSERT_EQ(drawn.analyze(solver), LinearOutcome::solved);
  UpdatedTangent fresh(drawn.equilibrium, solver, another);
  ASSERT_EQ(fresh.refresh(drawn.state), LinearOutcome::solved);
  ASSERT_EQ(fresh.solve(force, 1e-10, anew), LinearOutcome::solved);
  // Columns are as accurate as corrections need.
  EXPECT_LT(tests::distance(updated, anew), 1e-5 * tests::norm(anew));
  EXPECT_GT(tests::distance(updated, whole), 1e-2 * tests::norm(anew));

  UpdatedTangent same(drawn.equilibrium, solver, another);
  same.become(reference);
  ASSERT_TRUE(same.is_there());
  ASSERT_EQ(same.solve(force, 1e-10, again), LinearOutcome::solved);
  EXPECT_EQ(again, updated);
}

}  // namespace
}  // namespace peristat
