#include "cases/runner/results/tables/convergence_table.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace peristat {
namespace {

void add_search(ConvergenceTable& table, const std::vector<double>& residuals) {
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    IterationRecord row;
    row.iteration = int(k);
    row.residual = residuals[k];
    table.add(row);
  }
}

/// Ratios whose linear systems were solved to a tolerance.
std::vector<ResidualRatio> ratios(const std::vector<double>& values, double tolerance = 0.0) {
  std::vector<ResidualRatio> result;
  for (const double value : values) result.push_back({value, tolerance});
  return result;
}

TEST(ConvergenceTable, HasAColumnPerAcceptedStepNormalisedByItsJump) {
  ConvergenceTable table;
  add_search(table, {4.0, 2.0, 1.0});  // given up
  add_search(table, {8.0, 1.0, 0.125});
  table.accept(1);
  add_search(table, {2.0, 0.25, 0.03125, 0.00048828125, 1.1920928955078125e-7});
  table.accept(2);
  add_search(table, {1.0});  // not accepted
  EXPECT_EQ(table.csv(),
            "iteration,step_1,step_2\n"
            "0,1,1\n"
            "1,0.125,0.125\n"
            "2,0.015625,0.015625\n"
            "3,,0.000244140625\n"
            "4,,5.960464477539063e-08\n"
            "observed_order,,2\n");
}

TEST(ConvergenceTable, OfARunWithoutAcceptedStepsHasNoColumns) {
  ConvergenceTable table;
  add_search(table, {1.0, 0.5});
  EXPECT_EQ(table.csv(), "iteration\nobserved_order\n");
}

TEST(ConvergenceTable, TakesAStepWithoutResidual) {
  ConvergenceTable table;
  add_search(table, {0.0});
  table.accept(1);
  EXPECT_EQ(table.csv(), "iteration,step_1\n0,0\nobserved_order,\n");
}

TEST(ObservedOrder, IsThatOfTheLastResidualsAboveRoundOff) {
  // Table 3 of [CPD], increment 1: the last residual is round-off.
  const auto order = observed_order(ratios({1.0, 8.97e-2, 1.14e-3, 2.41e-7, 1.23e-14}));
  ASSERT_TRUE(order);
  EXPECT_NEAR(*order, std::log(2.41e-7 / 1.14e-3) / std::log(1.14e-3 / 8.97e-2), 1e-14);
  EXPECT_NEAR(*order, 1.94, 0.005);
  const auto linear = observed_order(ratios({1.0, 1e-1, 1e-2, 1e-3}));
  ASSERT_TRUE(linear);
  EXPECT_NEAR(*linear, 1.0, 1e-14);
  EXPECT_FALSE(observed_order(ratios({1.0, 1e-3, 1e-14})));    // one ratio only
  EXPECT_FALSE(observed_order(ratios({1.0, 0.9, 0.5, 0.4})));  // still far
  EXPECT_FALSE(observed_order(ratios({})));
}

TEST(ObservedOrder, IsNotThatOfTheLinearSolver) {
  const std::vector<double> quadratic{1.0, 1e-1, 1e-3, 1e-7};
  EXPECT_TRUE(observed_order(ratios(quadratic, 1e-7)));
  // Systems solved to a share of 1e-4 leave 1e-7 of 1e-3: what is seen is that.
  EXPECT_FALSE(observed_order(ratios(quadratic, 1e-4)));
  EXPECT_FALSE(observed_order(ratios({1.0, 1e-1, 1e-4, 1e-7}, 1e-3)));
}

}  // namespace
}  // namespace peristat
