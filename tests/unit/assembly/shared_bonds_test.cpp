#include "assembly/terms/failure/shared_bonds.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace peristat {
namespace {

using Rounds = std::vector<std::vector<std::size_t>>;

TEST(SharedBonds, ComeInTheOrderOfTheirUtilisationAndThenOfTheirPoints) {
  const std::vector<SharedBond> all = in_order(
      SoleRank(),
      {{1.5, {9, 4}, 0, 0}, {2.5, {1, 7}, 0, 1}, {1.5, {2, 8}, 0, 2}, {1.5, {2, 3}, 0, 3}});
  std::vector<std::size_t> numbers;
  for (const SharedBond& one : all) numbers.push_back(one.number);
  EXPECT_EQ(numbers, (std::vector<std::size_t>{1, 3, 2, 0}));
  EXPECT_EQ(all.back().ends[0], 4);
}

/// A bond waits for those before it that share a point with it, and for no others.
TEST(SharedBonds, AreDecidedOnInRounds) {
  EXPECT_EQ(rounds_of({}, LossReaches::bonds_of_points), Rounds());
  std::vector<SharedBond> bonds(6);
  const int ends[6][2] = {{1, 2}, {3, 4}, {2, 3}, {5, 6}, {1, 2}, {4, 6}};
  for (std::size_t k = 0; k < 6; ++k) bonds[k].ends = {ends[k][0], ends[k][1]};
  EXPECT_EQ(rounds_of(bonds, LossReaches::bonds_of_points), (Rounds{{0, 1, 3}, {2, 5}, {4}}));
  EXPECT_EQ(rounds_of(std::span(bonds).first(3), LossReaches::any_bond), (Rounds{{0}, {1}, {2}}));
}

}  // namespace
}  // namespace peristat
