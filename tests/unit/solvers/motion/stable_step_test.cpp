#include "solvers/motion/stable_step.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "tests/problems.hpp"

namespace peristat {
namespace {

using tests::Problem;
using tests::small_box;

/// All eigenvalues of M^-1 K on the free degrees of freedom, from products with unit vectors.
double largest_eigenvalue(const Problem& problem, const std::vector<double>& mass) {
  const std::vector<Index>& dof = problem.free.dof;
  Eigen::MatrixXd matrix(dof.size(), dof.size());
  std::vector<double> unit(mass.size(), 0.0), column(mass.size());
  for (std::size_t e = 0; e < dof.size(); ++e) {
    unit[dof[e]] = 1.0;
    problem.tangent.multiply(unit, column);
    unit[dof[e]] = 0.0;
    for (std::size_t r = 0; r < dof.size(); ++r) {
      matrix(Eigen::Index(r), Eigen::Index(e)) =
          column[dof[r]] / std::sqrt(mass[dof[r]] * mass[dof[e]]);
    }
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues().maxCoeff();
}

std::vector<double> masses(const Problem& problem) {
  std::vector<double> mass;
  for (std::size_t k = 0; k < problem.body.points.reference.size(); ++k) {
    mass.push_back(0.5 + std::pow(std::sin(double(k / std::size_t(problem.free.dimension))), 2));
  }
  return mass;
}

TEST(StableStep, IsBoundedFromBothSidesByTheEigenvalue) {
  for (const int dimension : {1, 2, 3}) {
    for (const bool is_held : {false, true}) {
      SCOPED_TRACE(std::to_string(dimension) + (is_held ? " held" : " free"));
      std::vector<SupportSpecification> supports;
      if (is_held) supports.push_back(tests::support("left", "0"));
      Problem problem(small_box(dimension), supports, {});
      problem.tangent.linearise(problem.assembler, problem.at_rest(), 1.0);
      const std::vector<double> mass = masses(problem);
      const double exact = largest_eigenvalue(problem, mass);
      const Stiffness found = find_stiffness(problem.tangent, problem.free, mass, 2);
      EXPECT_GE(found.eigenvalue, exact);
      EXPECT_LE(found.eigenvalue, 1.011 * exact);
      EXPECT_GE(found.bound, exact);
      EXPECT_LE(found.bound, 2.5 * exact);
      EXPECT_DOUBLE_EQ(found.stable_step(), 2.0 / std::sqrt(found.eigenvalue));
      const Stiffness bounded = bound_stiffness(problem.tangent, problem.free, mass, 2);
      EXPECT_EQ(bounded.bound, found.bound);
      EXPECT_EQ(bounded.eigenvalue, found.bound);
    }
  }
}

TEST(StableStep, SeesASinglePointThatIsLight) {
  Problem problem(small_box(2), {}, {});
  problem.tangent.linearise(problem.assembler, problem.at_rest(), 1.0);
  std::vector<double> mass(problem.body.points.reference.size(), 1.0);
  mass[60] = mass[61] = 1e-3;
  const double exact = largest_eigenvalue(problem, mass);
  const Stiffness found = find_stiffness(problem.tangent, problem.free, mass, 2);
  EXPECT_GE(found.eigenvalue, exact);
  EXPECT_LE(found.eigenvalue, 1.011 * exact);
}

TEST(StableStep, IsInfiniteWhereNothingMoves) {
  Problem problem(small_box(1), {tests::support("all", "0")}, {});
  problem.tangent.linearise(problem.assembler, problem.at_rest(), 1.0);
  const std::vector<double> mass(problem.body.points.reference.size(), 1.0);
  EXPECT_EQ(find_stiffness(problem.tangent, problem.free, mass, 2).stable_step(),
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace peristat
