#include "solvers/problem/consistency.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/search/newton.hpp"
#include "tests/problems.hpp"

namespace peristat {
namespace {

using tests::Problem;
using tests::support;

const tests::BoxSetting box = tests::small_box(2);

/// A plate in equilibrium, pulled and sheared, and the ledger of having got there.
struct Pulled {
  Problem problem;
  NewtonResult result;
  Ledger ledger;

  Pulled()
      : problem(box,
                {support("left", "0", "0"),
                 support("right", text(0.02) + "*load", text(0.01) + "*load")},
                {}) {
    Cholesky solver;
    EXPECT_EQ(problem.analyze(solver), LinearOutcome::solved);
    result = newton(problem.equilibrium, solver, problem.tangent, problem.at_rest(), 1.0, {}, {});
    EXPECT_EQ(result.outcome, Outcome::converged);
    ledger.stored = ledger.external_work = result.state.stored_energy;
  }

  static std::string text(double share) {
    return std::to_string(share * box.extent[0] * box.spacing);
  }

  /// What is wrong with the state, or with one that was tampered with.
  std::string fault(const Trial& trial, const Ledger& before, const Ledger& after,
                    bool sums_all_work = false) {
    return find_inconsistency(
        problem.equilibrium, problem.assembler, problem.tangent,
        {trial, result.external_force, result.largest_residual, sums_all_work, before, after});
  }
};

TEST(Consistency, FindsNothingInAnEquilibrium) {
  Pulled pulled;
  EXPECT_EQ(pulled.fault(pulled.result.state, {}, pulled.ledger), "");
  EXPECT_EQ(pulled.fault(pulled.result.state, {}, pulled.ledger, true), "");
}

TEST(Consistency, FindsAStateThatIsNoEquilibrium) {
  Pulled pulled;
  Trial moved = pulled.result.state;
  moved.displacement[std::size_t(pulled.problem.free.dof[3])] += 1e-6 * box.spacing;
  EXPECT_NE(pulled.fault(moved, {}, pulled.ledger).find("evaluated again"), std::string::npos);
}

// As when the rows of a thread are left out.
TEST(Consistency, FindsForcesThatDoNotAddUp) {
  Pulled pulled;
  Trial partial = pulled.result.state;
  for (std::size_t dof = partial.gradient.size() / 2; dof < partial.gradient.size(); ++dof) {
    partial.gradient[dof] = 0.0;
  }
  EXPECT_NE(pulled.fault(partial, {}, pulled.ledger).find("forces add up"), std::string::npos);
  // Even the smallest part that is more than round-off.
  partial = pulled.result.state;
  partial.gradient[0] *= 1.0 + 1e-9;
  EXPECT_NE(pulled.fault(partial, {}, pulled.ledger), "");
}

TEST(Consistency, FindsMomentsThatDoNotAddUp) {
  Pulled pulled;
  Trial turned = pulled.result.state;
  const double couple = 1e-6 * turned.gradient[0];
  turned.gradient[0] += couple;
  turned.gradient[turned.gradient.size() - 2] -= couple;  // the other end, further up
  EXPECT_NE(pulled.fault(turned, {}, pulled.ledger).find("moments"), std::string::npos);
}

TEST(Consistency, FindsEnergyFromNothing) {
  Pulled pulled;
  const Trial& trial = pulled.result.state;
  Ledger torn = pulled.ledger;
  torn.dissipated = 20.0 * torn.stored;  // damage that no work has paid for
  EXPECT_NE(pulled.fault(trial, {}, torn).find("without a source"), std::string::npos);
  Ledger gained = pulled.ledger;
  gained.drained = -0.2 * gained.stored;
  EXPECT_NE(pulled.fault(trial, {}, gained, true).find("without a source"), std::string::npos);
  EXPECT_EQ(pulled.fault(trial, {}, gained, false), "");  // elastic: nothing is drained there
}

TEST(Consistency, FindsEnergiesOfTheWrongSign) {
  Pulled pulled;
  const Trial& trial = pulled.result.state;
  Ledger negative = pulled.ledger;
  negative.stored = -negative.stored;
  EXPECT_NE(pulled.fault(trial, {}, negative).find("stored energy is negative, -"),
            std::string::npos);
  Ledger before = pulled.ledger;
  before.dissipated = pulled.ledger.stored;
  EXPECT_NE(pulled.fault(trial, before, pulled.ledger).find("falls"), std::string::npos);
}

TEST(Consistency, FindsNumbersThatHaveLostTheirDigits) {
  Pulled pulled;
  Trial tiny = pulled.result.state;
  for (double& entry : tiny.displacement) entry *= 1e-160;
  for (double& entry : tiny.gradient) entry *= 1e-160;
  Ledger ledger;
  EXPECT_NE(pulled.fault(tiny, {}, ledger).find("vanish"), std::string::npos);
}

TEST(Consistency, FindsBondsAboveWhatTheyBear) {
  tests::BoxSetting brittle = box;
  brittle.potential = [](double micromodulus) {
    return Degraded<CriticalStretch>{micromodulus, {1e-3}};
  };
  Problem problem(brittle, {support("left", "0", "0"), support("right", "0.1*load", "0")}, {});
  Trial stretched;
  stretched.displacement.assign(problem.body.dofs(), 0.0);
  stretched.history = problem.assembler.initial_history();
  for (std::size_t k = 0; k < stretched.displacement.size(); k += 2) {
    stretched.displacement[k] = 2e-3 * problem.body.points.reference[k];
  }
  const std::vector<double> no_force(problem.body.dofs(), 0.0);
  evaluate(problem.equilibrium, no_force, stretched, Damage::held);
  Ledger ledger;
  ledger.stored = stretched.stored_energy;
  const std::string fault =
      find_inconsistency(problem.equilibrium, problem.assembler, problem.tangent,
                         {stretched, no_force, -1.0, false, {}, ledger});
  EXPECT_NE(fault.find("beyond their limit"), std::string::npos) << fault;
}

}  // namespace
}  // namespace peristat
