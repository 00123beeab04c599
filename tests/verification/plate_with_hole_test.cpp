// The elastic plate with a hole: balance, symmetry, and the order of the energy ledger.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/verification/solved_case.hpp"

namespace peristat {
namespace {

TEST(PlateWithHole, ReactionsBalanceAndDisplacementsAreSymmetric) {
  const SolvedCase plate = solve_case("plate_with_hole/elastic.toml");
  ASSERT_EQ(plate.result.outcome, Outcome::converged);
  const StepRecord& last = plate.steps.back();
  const double pull = last.reactions.at("right")[0];
  // Without the hole and with free lateral contraction E w h (2 u / L) = 12 800 N. The hole (a
  // tenth of the section over a fifteenth of the length) and the missing bonds at edges weaken, the
  // held ends and the lattice's sum stiffen; none by more than a tenth.
  EXPECT_NEAR(pull / (192e9 * 0.05 * 1e-3 * (2e-4 / 0.15)), 1.0, 0.1);
  EXPECT_NEAR(last.reactions.at("left")[0] / pull, -1.0, 1e-8);
  EXPECT_NEAR(last.reactions.at("right")[1] / pull, 0.0, 1e-8);
  EXPECT_NEAR(plate.mean_displacement("left", 0), -1e-4, 1e-18);
}

TEST(PlateWithHole, LedgerOfElasticStepsClosesWithTheCubeOfTheStep) {
  // The trapezoidal rule's error of one step falls with its cube, so that of all steps to the same
  // load with the square.
  const double coarse = solve_case("plate_with_hole/elastic.toml", {{"loading.steps", "2"}})
                            .steps.back()
                            .balance_error;
  const double fine = solve_case("plate_with_hole/elastic.toml", {{"loading.steps", "4"}})
                          .steps.back()
                          .balance_error;
  ASSERT_NE(fine, 0.0);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1);
}

}  // namespace
}  // namespace peristat
