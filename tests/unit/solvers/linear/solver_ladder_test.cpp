#include "solvers/linear/solver_ladder.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/operators/tangent.hpp"
#include "solvers/linear/cholesky.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

/// Ends every call of one kind with an outcome, and the others well.
class Scripted : public LinearSolver {
 public:
  LinearOutcome of_analyze = LinearOutcome::solved, of_factorize = LinearOutcome::solved,
                of_solve = LinearOutcome::solved;

  LinearOutcome analyze(const BlockPattern&, const FreeDofs&) override { return of_analyze; }
  LinearOutcome factorize(const TangentOperator&, FactorUse) override { return of_factorize; }
  void count_pivots(bool) override {}
  LinearOutcome solve(std::span<const double>, std::span<double>, double) override {
    return of_solve;
  }
  [[nodiscard]] std::optional<Inertia> inertia() const override { return std::nullopt; }
  [[nodiscard]] LinearStatistics statistics() const override { return {1, 10, 0.5}; }
  [[nodiscard]] int last_iterations() const override { return 10; }
  [[nodiscard]] std::string describe() const override { return "scripted"; }
};

struct LadderOnABox {
  tests::BoxBody body{tests::small_box(2)};
  FreeDofs free{held(), 2};
  Tangent tangent{BlockPattern(body.model.bonds()), 2};
  std::vector<double> b, x;
  std::vector<std::string> told;

  LadderOnABox() : b(std::size_t(free.count()), 1.0), x(b.size()) {
    Assembler(body.points, body.model, 1).tangent(std::vector<double>(body.dofs(), 0.0), tangent);
  }

  std::vector<char> held() const {
    std::vector<char> prescribed(body.dofs(), 0);
    std::fill_n(prescribed.begin(), 6, 1);
    return prescribed;
  }

  static SolverLadder::Rung scripted(const std::string& name, const Scripted& script) {
    return {name, [script] { return std::make_unique<Scripted>(script); }};
  }
  static SolverLadder::Rung direct() {
    return {"direct", [] { return std::make_unique<Cholesky>(); }};
  }

  SolverLadder make(std::vector<SolverLadder::Rung> rungs) {
    return SolverLadder(std::move(rungs), [this](const std::string& why) { told.push_back(why); });
  }

  LinearOutcome run(SolverLadder& ladder) {
    LinearOutcome outcome = ladder.analyze(tangent.pattern, free);
    if (outcome == LinearOutcome::solved) {
      outcome = ladder.factorize(tangent, FactorUse::factorize_now);
    }
    if (outcome == LinearOutcome::solved) outcome = ladder.solve(b, x, 1e-10);
    return outcome;
  }
};

Scripted failing(LinearOutcome Scripted::*call, LinearOutcome outcome) {
  Scripted script;
  script.*call = outcome;
  return script;
}

TEST(SolverLadder, FallsWhereverASolverFailsAndSolvesAgain) {
  for (const auto call : {&Scripted::of_analyze, &Scripted::of_factorize, &Scripted::of_solve}) {
    for (const auto outcome : {LinearOutcome::out_of_memory, LinearOutcome::inaccurate}) {
      LadderOnABox box;
      const auto rung = LadderOnABox::scripted("first", failing(call, outcome));
      SolverLadder ladder = box.make({rung, rung, LadderOnABox::direct()});
      EXPECT_EQ(box.run(ladder), LinearOutcome::solved);
      ASSERT_EQ(box.told.size(), 2u);
      EXPECT_EQ(box.told[0], "first ended with " + name(outcome) + ": first from now on");
      EXPECT_EQ(box.told[1], "first ended with " + name(outcome) + ": direct from now on");
      std::vector<double> full(box.body.dofs()), product(full.size()), again(box.b.size());
      box.free.extend_by_zero(box.x, full);
      box.tangent.multiply(full, product);
      box.free.restrict_to_free(product, again);
      EXPECT_LE(tests::distance(again, box.b), 1e-10 * tests::norm(box.b));
      // For good: the next system is the last rung's at once.
      EXPECT_EQ(ladder.factorize(box.tangent, FactorUse::factorize_now), LinearOutcome::solved);
      EXPECT_EQ(ladder.solve(box.b, box.x, 1e-10), LinearOutcome::solved);
      EXPECT_EQ(box.told.size(), 2u);
      EXPECT_EQ(ladder.statistics().factorisations, 2 + 2);  // both that fell, and its own
      EXPECT_EQ(ladder.statistics().iterations, 20);
    }
  }
}

TEST(SolverLadder, StaysOnItsRungWhenFreedomsChange) {
  LadderOnABox box;
  SolverLadder ladder = box.make(
      {LadderOnABox::scripted("first", failing(&Scripted::of_solve, LinearOutcome::inaccurate)),
       LadderOnABox::scripted("second", {})});
  ASSERT_EQ(box.run(ladder), LinearOutcome::solved);
  ASSERT_EQ(box.told.size(), 1u);
  const LinearStatistics before = ladder.statistics();
  EXPECT_EQ(box.run(ladder), LinearOutcome::solved);  // analyzed anew, as after pinning
  EXPECT_EQ(box.told.size(), 1u);
  EXPECT_EQ(ladder.statistics().iterations, before.iterations + 10);
  EXPECT_EQ(ladder.statistics().factorisations, before.factorisations + 1);
}

TEST(SolverLadder, PassesOnWhatIsTrueOfTheTangent) {
  for (const auto outcome : {LinearOutcome::not_positive_definite, LinearOutcome::singular}) {
    LadderOnABox box;
    SolverLadder ladder =
        box.make({LadderOnABox::scripted("first", failing(&Scripted::of_solve, outcome)),
                  LadderOnABox::direct()});
    EXPECT_EQ(box.run(ladder), outcome);
    EXPECT_TRUE(box.told.empty());
  }
}

TEST(SolverLadder, EndsWithTheLastSolversOutcome) {
  LadderOnABox box;
  const auto rung = [](LinearOutcome outcome) {
    return LadderOnABox::scripted("rung", failing(&Scripted::of_solve, outcome));
  };
  SolverLadder ladder =
      box.make({rung(LinearOutcome::inaccurate), rung(LinearOutcome::out_of_memory)});
  EXPECT_EQ(box.run(ladder), LinearOutcome::out_of_memory);
  EXPECT_EQ(box.told.size(), 1u);
}

}  // namespace
}  // namespace peristat
