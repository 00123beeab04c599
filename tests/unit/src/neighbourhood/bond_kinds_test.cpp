#include "src/neighbourhood/bond_kinds.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

/// Kinds that differ by far more than round-off.
std::vector<BondKind> different(std::size_t count) {
  std::vector<BondKind> kinds;
  for (std::size_t k = 0; k < count; ++k) kinds.push_back({1.0 + 1e-6 * double(k), 2.0});
  return kinds;
}

BondKinds packed(const std::vector<BondKind>& kinds) {
  BondKinds result;
  for (const BondKind& kind : kinds) result.push_back(kind);
  return result;
}

void expect_equal(const BondKinds& kinds, const std::vector<BondKind>& expected) {
  ASSERT_EQ(kinds.size(), expected.size());
  for (std::size_t bond = 0; bond < expected.size(); ++bond) {
    ASSERT_EQ(kinds[Offset(bond)], expected[bond]) << "bond " << bond;
  }
}

TEST(BondKinds, GiveWhatWasPutIn) {
  std::vector<BondKind> kinds = different(1000);
  for (std::size_t k = 0; k < 1000; ++k) kinds.push_back({kinds[k].inverse_length, 3.0});
  for (std::size_t k = 0; k < 1000; ++k) kinds.push_back(kinds[(7 * k) % 2000]);
  const BondKinds result = packed(kinds);
  expect_equal(result, kinds);
  EXPECT_EQ(result.bytes_per_bond(), 2u);
}

TEST(BondKinds, OfMoreThan65536AreKeptOneByOne) {
  for (const std::size_t count : {65536u, 65537u, 70000u}) {
    std::vector<BondKind> kinds = different(count);
    kinds.push_back(kinds[5]);
    const BondKinds result = packed(kinds);
    expect_equal(result, kinds);
    EXPECT_EQ(result.bytes_per_bond(), count <= 65536 ? 2u : 16u);
  }
}

TEST(BondKinds, ThatDifferByRoundOffAreTheFirstOfThem) {
  const double length = 0.1 + 0.2;
  const BondKinds result =
      packed({{length, 1.0}, {0.3, 1.0}, {0.3 * (1.0 + 1e-10), 1.0}, {length, 1.0 + 1e-15}});
  EXPECT_NE(length, 0.3);
  expect_equal(result, {{length, 1.0}, {length, 1.0}, {0.3 * (1.0 + 1e-10), 1.0}, {length, 1.0}});
}

TEST(BondKinds, AppendedAreThoseOneAfterAnother) {
  const std::vector<std::size_t> sizes{0, 3000, 40000, 65536, 70000};
  for (const std::size_t first : sizes) {
    for (const std::size_t second : sizes) {
      std::vector<BondKind> one = different(first), two = different(second);
      for (BondKind& kind : two) kind.inverse_length += 1.0;
      BondKinds result = packed(one);
      result.append(packed(two));
      one.insert(one.end(), two.begin(), two.end());
      expect_equal(result, one);
    }
  }
}

TEST(BondKinds, ReweighedAreThoseOfTheNewWeights) {
  for (const std::size_t count : {1000u, 40000u, 70000u}) {  // the last ones have no numbers
    std::vector<BondKind> kinds = different(count);
    kinds.insert(kinds.end(), kinds.begin(), kinds.begin() + 900);
    // Few weights, and more kinds than have numbers.
    for (const std::size_t weights : {3u, 50000u}) {
      std::vector<BondKind> expected = kinds;
      const BondKinds before = packed(kinds);
      ReweighedKinds after(before);
      for (std::size_t bond = 0; bond < kinds.size(); ++bond) {
        expected[bond].weight = 1.0 + double(bond * 7 % weights);
        after.push_back(expected[bond].weight);
      }
      expect_equal(after.take(), expected);
    }
  }
}

TEST(BondKinds, AreCopiedAndTruncated) {
  for (const std::size_t count : {10u, 70000u}) {
    std::vector<BondKind> kinds = different(count);
    BondKinds result = packed(kinds);
    result.copy(Offset(count) - 1, 2);
    result.truncate(4);
    expect_equal(result, {kinds[0], kinds[1], kinds.back(), kinds[3]});
  }
}

TEST(BondKinds, OfALatticeAreFew) {
  for (const tests::Quadrature& quadrature :
       {tests::Quadrature{}, {VolumeCorrection::linear, SurfaceCorrection::energy}}) {
    tests::BoxSetting box = tests::small_box(3);
    box.extent = {25, 24, 23};
    box.spacing = 0.1 / 3.0;
    box.quadrature = quadrature;
    const tests::BoxBody body(box);
    EXPECT_GT(body.model.bonds().count(), 200000);
    EXPECT_EQ(body.model.bonds().kind.bytes_per_bond(), 1u);
    tests::for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset bond) {
      const double distance = tests::reference_distance(body.points, i, j);
      ASSERT_NEAR(body.model.bonds().length(bond) / distance, 1.0, 2e-12);
    });
  }
}

}  // namespace
}  // namespace peristat
