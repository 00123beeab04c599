#include "solvers/linear/make_linear_solver.hpp"

#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/linear/memory_estimate.hpp"
#include "solvers/linear/sparse_lu.hpp"
#include "tests/unsymmetric_operator.hpp"

namespace peristat {
namespace {

using tests::GridSetting;
using tests::GridSystem;

GridSetting grid(int side) {
  GridSetting of;
  of.side = side;
  return of;
}

double entries_per_row(const GridSystem& system) {
  return double(system.tangent.matrix.column.size()) / double(system.tangent.dofs());
}

LinearProblem problem_of(const GridSystem& system) {
  BodySize size;
  size.dimension = system.tangent.dimension;
  size.points = double(system.tangent.pattern.points());
  size.free_dofs = double(system.free.count());
  size.entries_per_row = entries_per_row(system);
  const MemoryEstimate estimate = estimate_memory(size);
  LinearProblem problem;
  problem.is_symmetric = false;
  problem.unknowns = size.free_dofs;
  problem.bonds = 0.25 * size.points * size.entries_per_row;
  problem.factor_flops = estimate.factor_flops;
  problem.factor_bytes = estimate.direct_bytes(LinearMethod::lu);
  return problem;
}

struct Made {
  ChosenSolver chosen;
  LinearOutcome outcome;
  std::vector<std::string> told;
};

Made make_and_solve(GridSystem& system, const LinearProblem& problem,
                    const LinearSolverOptions& options = {}) {
  Made made;
  made.chosen = make_linear_solver(options, problem,
                                   [&](const std::string& why) { made.told.push_back(why); });
  made.outcome = made.chosen.solver->analyze(system.tangent.pattern, system.free);
  if (made.outcome == LinearOutcome::solved) {
    made.outcome = system.solve(*made.chosen.solver, 1e-10);
  }
  return made;
}

TEST(MakeLinearSolver, TakesWhatIsNamedForAnUnsymmetricTangent) {
  GridSystem system(grid(16));
  const LinearProblem problem = problem_of(system);
  const auto local = PreconditionerKind::local_operator;
  const auto automatic = PreconditionerKind::automatic;
  const auto blocks = PreconditionerKind::block_jacobi;
  struct Choice {
    LinearMethod method;
    PreconditionerKind preconditioner;
    std::string described;
  };
  for (const Choice& choice :
       {Choice{LinearMethod::lu, automatic, "UMFPACK L U with pivoting"},
        Choice{LinearMethod::gmres, automatic, "GMRES preconditioned by local operator"},
        Choice{LinearMethod::gmres, local, "GMRES preconditioned by local operator"},
        Choice{LinearMethod::automatic, local, "GMRES preconditioned by local operator"},
        Choice{LinearMethod::gmres, blocks, "GMRES preconditioned by block Jacobi"},
        Choice{LinearMethod::bicgstab, automatic, "BiCGStab preconditioned by local operator"}}) {
    const Made made = make_and_solve(system, problem, {choice.method, choice.preconditioner});
    EXPECT_EQ(made.outcome, LinearOutcome::solved);
    EXPECT_LT(system.error(), 1e-7);
    EXPECT_EQ(made.chosen.solver->describe().substr(0, choice.described.size()), choice.described);
    EXPECT_EQ(made.chosen.is_direct, choice.method == LinearMethod::lu);
    EXPECT_EQ(made.chosen.reason, "as the case asks");
    EXPECT_GT(made.chosen.seconds, 0.0);
  }
}

TEST(MakeLinearSolver, ChoosesForAnUnsymmetricTangent) {
  GridSystem system(grid(16));
  const auto expect_chosen = [&](const LinearProblem& problem, const std::string& described,
                                 bool is_direct, const std::string& reason) {
    const Made made = make_and_solve(system, problem);
    EXPECT_EQ(made.outcome, LinearOutcome::solved);
    EXPECT_LT(system.error(), 1e-7);
    EXPECT_TRUE(made.told.empty());
    EXPECT_EQ(made.chosen.solver->describe().substr(0, described.size()), described);
    EXPECT_EQ(made.chosen.is_direct, is_direct);
    EXPECT_NE(made.chosen.reason.find(reason), std::string::npos) << made.chosen.reason;
    EXPECT_NE(made.chosen.reason.find("the tangent is not symmetric"), std::string::npos);
  };
  const LinearProblem small = problem_of(system);
  expect_chosen(small, "UMFPACK", true, "flops is small");
  LinearProblem problem = small;
  problem.factor_flops = 1e15;
  expect_chosen(problem, "GMRES preconditioned by local operator", false, "is estimated at");
  problem = small;
  problem.available_bytes = 0.9 * problem.factor_bytes;
  expect_chosen(problem, "GMRES preconditioned by local operator", false, "a factor would need");
  problem = small;
  problem.has_inertia = true;
  system.tangent.setting.mass = 300.0;
  system.tangent.assemble();
  system.find_right_hand_side();
  expect_chosen(problem, "BiCGStab preconditioned by block Jacobi", false, "masses dominate");
}

TEST(MakeLinearSolver, FallsWhereAnUnsymmetricSolverFails) {
  // Told to be so large that it should iterate, with a stand-in that is singular.
  struct WithoutStandIn : tests::GridOperator {
    using GridOperator::GridOperator;
    [[nodiscard]] SparseRows local_rows() const override {
      SparseRows made = GridOperator::local_rows();
      for (double& value : made.value) value = 0.0;
      return made;
    }
  };
  const GridSystem system(grid(16));
  const WithoutStandIn tangent(system.tangent.setting);
  LinearProblem problem = problem_of(system);
  problem.factor_flops = 1e15;
  std::vector<std::string> told;
  const ChosenSolver chosen =
      make_linear_solver({}, problem, [&](const std::string& why) { told.push_back(why); });
  std::vector<double> x(system.b.size());
  ASSERT_EQ(chosen.solver->analyze(tangent.pattern, system.free), LinearOutcome::solved);
  ASSERT_EQ(chosen.solver->factorize(tangent, FactorUse::factorize_now), LinearOutcome::solved);
  ASSERT_EQ(chosen.solver->solve(system.b, x, 1e-10), LinearOutcome::solved);
  EXPECT_LT(tests::distance(x, system.expected), 1e-9 * tests::norm(system.expected));
  EXPECT_EQ(told, std::vector<std::string>{
                      "gmres with local_operator ended with inaccurate: lu from now on"});
}

TEST(MakeLinearSolver, RefusesWhatDoesNotGoWithTheTangent) {
  LinearProblem symmetric, unsymmetric;
  unsymmetric.is_symmetric = false;
  const auto expect_for = [&](const LinearSolverOptions& options, bool for_symmetric,
                              bool for_unsymmetric) {
    for (const LinearProblem& problem : {symmetric, unsymmetric}) {
      const bool works = problem.is_symmetric ? for_symmetric : for_unsymmetric;
      const std::string method = what_is_against(options.method, problem.is_symmetric);
      const std::string other = what_is_against(options.preconditioner, problem.is_symmetric);
      EXPECT_EQ(method.empty() && other.empty(), works);
      if (works) {
        EXPECT_TRUE(make_linear_solver(options, problem, {}).solver);
      } else {
        EXPECT_THROW(static_cast<void>(make_linear_solver(options, problem, {})), std::logic_error);
      }
    }
  };
  using enum LinearMethod;
  for (const LinearMethod method : {cholesky, ldlt, conjugate_gradients, minres}) {
    expect_for({method, {}}, true, false);
  }
  for (const LinearMethod method : {lu, bicgstab}) expect_for({method, {}}, false, true);
  for (const LinearMethod method : {automatic, gmres}) expect_for({method, {}}, true, true);
  for (const auto preconditioner :
       {PreconditionerKind::rigid_pieces, PreconditionerKind::surrogate, PreconditionerKind::riluk,
        PreconditionerKind::chebyshev, PreconditionerKind::multigrid}) {
    expect_for({gmres, preconditioner}, true, false);
  }
  for (const auto preconditioner : {PreconditionerKind::jacobi, PreconditionerKind::block_jacobi}) {
    expect_for({gmres, preconditioner}, true, true);
  }
  expect_for({gmres, PreconditionerKind::local_operator}, false, true);
}

TEST(EstimateLu, IsOfTheSizeOfWhatUmfpackTakes) {
  for (const auto& [dimension, side, reach] :
       {std::tuple{2, 40, 3.01}, std::tuple{2, 100, 1.5}, std::tuple{3, 12, 2.1}}) {
    GridSetting of;
    of.dimension = dimension;
    of.side = side;
    of.reach = reach;
    GridSystem system(of);
    SparseLu solver;
    ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    ASSERT_EQ(system.solve(solver), LinearOutcome::solved);
    const LuEstimate estimate =
        estimate_lu(dimension, system.free.count(), entries_per_row(system));
    EXPECT_LT(estimate.entries / solver.factor().entries(), 2.0);
    EXPECT_GT(estimate.entries / solver.factor().entries(), 0.5);
    EXPECT_LT(estimate.flops / solver.factor().flops(), 3.0);
    EXPECT_GT(estimate.flops / solver.factor().flops(), 1.0 / 3.0);
  }
  // Never more than a full matrix.
  EXPECT_EQ(estimate_lu(3, 100.0, 100.0).entries, 1e4);
}

}  // namespace
}  // namespace peristat
