#include "assembly/operators/row_ranges.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

void expect_partition(const Bonds& bonds, int parts, Index own) {
  const BlockPattern pattern(bonds);
  const std::vector<RowRange> ranges = partition_rows(pattern, parts, own);
  ASSERT_EQ(ranges.size(), std::size_t(parts));
  Index next = 0;
  for (const RowRange& range : ranges) {
    EXPECT_EQ(range.first, next);
    EXPECT_GE(range.last, range.first);
    std::set<Index> near, far;  // partners beyond
    for (Index row = range.first; row < range.last; ++row) {
      for (const Index j : bonds.of(row)) {
        if (j >= range.last) (j < own ? near : far).insert(j);
      }
    }
    std::vector<Index> beyond;
    range.for_each_beyond([&](Index first, Index last) {
      EXPECT_GE(first, range.last);
      for (Index row = first; row < last; ++row) beyond.push_back(row);
    });
    ASSERT_EQ(Index(beyond.size()), range.rows_beyond());
    for (std::size_t k = 0; k < beyond.size(); ++k) {
      EXPECT_EQ(range.place_beyond(beyond[k]), Index(k));
    }
    for (const std::set<Index>& some : {near, far}) {
      EXPECT_TRUE(std::ranges::includes(beyond, some));
    }
    const Index of_near = near.empty() ? 0 : *near.rbegin() + 1 - range.last;
    const Index of_far = far.empty() ? 0 : *far.rbegin() + 1 - *far.begin();
    EXPECT_EQ(range.rows_beyond(), of_near + of_far);
    next = range.last;
  }
  EXPECT_EQ(next, pattern.points());
}

TEST(PartitionRows, CoversEveryRowOnce) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const tests::BoxBody body(tests::small_box(dimension));
    ASSERT_GT(body.points.count(), 20);
    for (int threads : {1, 2, 3, 5, 16, 1000}) {
      const Index count = body.points.count();
      for (const Index own : {count, count - 5, count / 2}) {
        expect_partition(body.model.bonds(), threads, own);
      }
    }
  }
}

TEST(PartitionRows, TakesRowsWithoutBonds) {
  Bonds bonds;
  bonds.offset.assign(11, 0);
  for (int threads : {1, 3}) expect_partition(bonds, threads, 10);
  EXPECT_EQ(partition_rows(BlockPattern(bonds), 2, 10)[0].last, 5);
}

TEST(PartitionRows, SharesBondsEvenly) {
  tests::BoxSetting box = tests::small_box(2);
  box.extent = {40, 30, 0};
  const tests::BoxBody body(box);
  const BlockPattern pattern(body.model.bonds());
  for (int threads : {2, 3, 5}) {
    for (const RowRange& range : partition_rows(pattern, threads, body.points.count())) {
      const double share = double(pattern.offset[range.last] - pattern.offset[range.first]);
      EXPECT_NEAR(share * threads / double(pattern.blocks()), 1.0, 0.05);
    }
  }
}

int parts_of(const tests::BoxBody& body, int threads) {
  return parts_of_rows(BlockPattern(body.model.bonds()), threads, body.points.count());
}

TEST(PartsOfRows, AreAsManyAsLeaveFewRowsBeyondThem) {
  tests::BoxSetting strip = tests::small_box(2), cube = tests::small_box(3);
  strip.extent = {2000, 10, 0};
  cube.extent = {12, 12, 12};
  const tests::BoxBody long_one(strip), thick(cube);
  for (const int threads : {1, 2, 16}) {
    EXPECT_EQ(parts_of(long_one, threads), 48);
  }
  EXPECT_EQ(parts_of(long_one, 64), 64);
  const int few = parts_of(thick, 1);
  EXPECT_GT(few, 1);
  EXPECT_LT(few, 48);
  EXPECT_EQ(parts_of(thick, 47), 47);
}

}  // namespace
}  // namespace peristat
