#include "src/neighbourhood/partners.hpp"

#include <cstddef>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

/// Rows of points that may have partners above them.
using Rows = std::vector<std::vector<Index>>;

Partners made_of(const Rows& rows, Index first = 0) {
  PartnersBuilder builder(first);
  for (const std::vector<Index>& row : rows) builder.add(row);
  return builder.take();
}

std::vector<Offset> offsets_of(const Rows& rows) {
  std::vector<Offset> offset{0};
  for (const std::vector<Index>& row : rows) offset.push_back(offset.back() + Offset(row.size()));
  return offset;
}

void expect_rows(const Partners& partners, const Rows& rows) {
  const std::vector<Offset> offset = offsets_of(rows);
  ASSERT_EQ(partners.size(), offset.back());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const PartnersOfPoint row = partners.between(Index(i), offset[i], offset[i + 1]);
    EXPECT_EQ(std::vector<Index>(row.begin(), row.end()), rows[i]) << "point " << i;
    for (std::size_t k = 0; k < rows[i].size(); ++k) {
      EXPECT_EQ(partners(Index(i), offset[i] + Offset(k)), rows[i][k]);
      EXPECT_EQ(row.place_of(rows[i][k]), Offset(k));
    }
    EXPECT_FALSE(row.place_of(Index(i)));
    EXPECT_FALSE(row.place_of(1000));
  }
}

/// A chain of points, each bonded to the next two; a hole, and a row that is alike by its sum.
const Rows chain = {{1, 2}, {2, 3}, {3, 4}, {}, {5, 6}, {}, {7, 10}, {8, 9, 10}, {9, 10}, {10}, {}};

TEST(Partners, AreThoseThatWereAdded) { expect_rows(made_of(chain), chain); }

TEST(Partners, AreThoseOfOffsetsAndUpperPoints) {
  std::vector<Index> upper;
  for (const std::vector<Index>& row : chain) upper.insert(upper.end(), row.begin(), row.end());
  expect_rows(Partners(offsets_of(chain), upper), chain);
}

TEST(Partners, KeepsRowsThatAreAlikeOnce) {
  Rows line(1000);
  for (Index i = 0; i < 997; ++i) line[std::size_t(i)] = {i + 1, i + 2, i + 3};
  const Partners partners = made_of(line);
  expect_rows(partners, line);
  EXPECT_EQ(partners.bytes(), 3 * sizeof(Index) + line.size() * sizeof(Offset));
}

TEST(Partners, AreJoinedFromParts) {
  const std::vector<Offset> offset = offsets_of(chain);
  for (std::size_t cut = 0; cut <= chain.size(); ++cut) {
    const auto middle = chain.begin() + std::ptrdiff_t(cut);
    PartnersBuilder joined;
    const std::span<const Offset> all = offset;
    joined.append(made_of({chain.begin(), middle}), all.first(cut + 1));
    joined.append(made_of({middle, chain.end()}, Index(cut)), all.subspan(cut));
    expect_rows(joined.take(), chain);
  }
}

TEST(Partners, OfALatticeTakeLittleMemory) {
  tests::BoxSetting box = tests::small_box(3);
  box.extent = {25, 24, 23};
  const tests::BoxBody body(box);
  const Bonds& bonds = body.model.bonds();
  // 8 bytes are of the point; 9 are of nearly all rows of steps that differ.
  EXPECT_LT(double(bonds.partner.bytes()), 17.0 * double(bonds.points()));
}

TEST(KindNumbers, TakeABytePerNumberUntilOneDoesNotFit) {
  KindNumbers numbers;
  for (std::uint16_t k = 0; k < 256; ++k) numbers.push_back(k);
  EXPECT_EQ(numbers.bytes_per_number(), 1u);
  numbers.push_back(65535);
  numbers.push_back(256);
  EXPECT_EQ(numbers.bytes_per_number(), 2u);
  ASSERT_EQ(numbers.size(), 258u);
  for (std::uint16_t k = 0; k < 256; ++k) EXPECT_EQ(numbers[k], k);
  EXPECT_EQ(numbers[256], 65535);
  EXPECT_EQ(numbers[257], 256);
  numbers.copy(256, 3);
  numbers.truncate(4);
  EXPECT_EQ(numbers.size(), 4u);
  EXPECT_EQ(numbers[3], 65535);
}

}  // namespace
}  // namespace peristat
