#include "solvers/fracture/remaining_life.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

/// A chain of points 0 to 5, each bonded to the next one.
Bonds chain() {
  Bonds bonds = tests::bonds_between({0, 1, 2, 3, 4, 5, 5}, {1, 2, 3, 4, 5});
  for (int bond = 0; bond < 5; ++bond) bonds.kind.push_back({1.0, 1.0});
  return bonds;
}

TEST(LifeLaw, IsAPowerOfTheRangeAboveTheLimit) {
  const LifeLaw law{2.0, 3.0, 0.01};
  EXPECT_DOUBLE_EQ(law.rate(0.03), 2.0 * std::pow(0.02, 3.0));
  EXPECT_EQ(law.rate(0.01), 0.0);
  EXPECT_EQ(law.rate(0.005), 0.0);
  EXPECT_EQ(law.rate(std::nan("")), 0.0);
  EXPECT_TRUE(law.acts());
  EXPECT_FALSE(LifeLaw{}.acts());
  EXPECT_EQ(LifeLaw{}.rate(0.1), 0.0);
}

TEST(LifeLaw, TakesRoundOffForNoRange) {
  const LifeLaw law{1e30, 0.5, 0.0};
  EXPECT_EQ(law.rate(1e-13), 0.0);
  EXPECT_GT(law.rate(1e-11), 0.0);
}

TEST(FatigueOptions, TakeTheRangeOfAProportionalCycle) {
  FatigueOptions options;
  options.load_ratio = 0.25;
  EXPECT_DOUBLE_EQ(options.range(0.04), 0.03);
  EXPECT_DOUBLE_EQ(options.range(-0.04), 0.03);
  options.load_ratio = -1.0;
  EXPECT_DOUBLE_EQ(options.range(0.04), 0.08);
}

TEST(CyclesToFirst, IsTheLeastQuotientOfLifeAndRate) {
  EXPECT_DOUBLE_EQ(cycles_to_first(std::vector{1.0, 0.5, 0.1}, std::vector{0.1, 0.1, 0.0}), 5.0);
  EXPECT_EQ(cycles_to_first(std::vector{1.0, 0.5}, std::vector{0.0, 0.0}),
            std::numeric_limits<double>::infinity());
}

TEST(WornBonds, AreThoseWithoutLifeThatAge) {
  const std::vector<double> rates{1.0, 1.0, 0.0, 1.0, 1.0};
  EXPECT_EQ(worn_bonds(std::vector{0.5, 0.0, 0.0, 1e-9, 1e-3}, rates, 0.0),
            (std::vector<Offset>{1, 3}));
  EXPECT_EQ(worn_bonds(std::vector{0.5, 0.0, 0.0, 1e-9, 1e-3}, rates, 0.01),
            (std::vector<Offset>{1, 3, 4}));
}

TEST(WornBonds, EndAtAGapWithinAFewTies) {
  const double tie = life_tie;
  const std::vector<double> rates(4, 1.0);
  // Round-off may not separate two equal bonds at the limit.
  EXPECT_EQ(worn_bonds(std::vector{0.0, 0.99 * tie, 1.01 * tie, 1.0}, rates, 0.0).size(), 3U);
  EXPECT_EQ(worn_bonds(std::vector{0.0, 0.5 * tie, 5.0 * tie, 1.0}, rates, 0.0).size(), 2U);
  // A chain of ties comes to an end.
  std::vector<double> dense(1000);
  for (std::size_t k = 0; k < dense.size(); ++k) dense[k] = 0.5 * tie * double(k);
  EXPECT_LE(worn_bonds(dense, std::vector(dense.size(), 1.0), 0.0).size(), 24U);
}

TEST(NoteCracks, ChangesBondsWithinTwoHorizonsOnce) {
  const Bonds bonds = chain();
  RemainingLives lives{{0.1, 0.2, 0.3, 0.4, 0.5}, {0, 0, 0, 0, 0}};
  const std::vector<double> damage{0.3, 0.1, 0.0, 0.0, 0.0, 0.0};
  const std::vector<char> broken{1, 0, 0, 0, 0};
  note_cracks(bonds, {}, damage, 0.3, broken, lives);
  EXPECT_EQ(lives.near_crack, (std::vector<char>{0, 1, 0, 0, 0}));
  EXPECT_EQ(lives.life, (std::vector{0.1, 1.0, 0.3, 0.4, 0.5}));
  lives.life[1] = 0.7;
  note_cracks(bonds, {}, damage, 0.3, broken, lives);
  EXPECT_EQ(lives.life[1], 0.7);
}

TEST(NoteCracks, SeesNeighboursAcrossThePreCrack) {
  RemainingLives lives{std::vector(5, 0.5), std::vector<char>(5, 0)};
  const std::vector<BondEnds> cut{{0, 4}};
  note_cracks(chain(), cut, std::vector{1.0, 0.0, 0.0, 0.0, 0.0, 0.0}, 0.3, std::vector<char>(5, 0),
              lives);
  EXPECT_EQ(lives.near_crack, (std::vector<char>{1, 1, 0, 1, 1}));
}

}  // namespace
}  // namespace peristat
