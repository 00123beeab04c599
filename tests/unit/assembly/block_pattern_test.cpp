#include "assembly/operators/block_pattern.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

void expect_partition(const Bonds& bonds, int threads) {
  const BlockPattern pattern(bonds);
  const std::vector<RowRange> ranges = partition_rows(pattern, threads);
  ASSERT_EQ(ranges.size(), std::size_t(threads));
  Index next = 0;
  for (const RowRange& range : ranges) {
    EXPECT_EQ(range.first, next);
    EXPECT_GE(range.last, range.first);
    Index reach = range.last;
    for (Index row = range.first; row < range.last; ++row) {
      for (Offset bond = bonds.offset[row]; bond < bonds.offset[row + 1]; ++bond) {
        reach = std::max(reach, bonds.partner(row, bond) + 1);
      }
    }
    EXPECT_EQ(range.touched_end, reach);
    next = range.last;
  }
  EXPECT_EQ(next, pattern.points());
}

TEST(PartitionRows, CoversEveryRowOnce) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const tests::BoxBody body(tests::small_box(dimension));
    ASSERT_GT(body.points.count(), 20);
    for (int threads : {1, 2, 3, 5, 16, 1000}) expect_partition(body.model.bonds(), threads);
  }
}

TEST(PartitionRows, TakesRowsWithoutBonds) {
  Bonds bonds;
  bonds.offset.assign(11, 0);
  for (int threads : {1, 3}) expect_partition(bonds, threads);
  EXPECT_EQ(partition_rows(BlockPattern(bonds), 2)[0].last, 5);
}

TEST(PartitionRows, SharesBondsEvenly) {
  tests::BoxSetting box = tests::small_box(2);
  box.extent = {40, 30, 0};
  const tests::BoxBody body(box);
  const BlockPattern pattern(body.model.bonds());
  for (int threads : {2, 3, 5}) {
    for (const RowRange& range : partition_rows(pattern, threads)) {
      const double share = double(pattern.offset[range.last] - pattern.offset[range.first]);
      EXPECT_NEAR(share * threads / double(pattern.blocks()), 1.0, 0.05);
    }
  }
}

}  // namespace
}  // namespace peristat
