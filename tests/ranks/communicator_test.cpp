#include "src/parallel/communicator.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/ranks/on_ranks.hpp"

namespace peristat::tests {
namespace {

/// What a rank gives: of very different sizes, so that the order of a sum shows in its bits.
double number_of(int rank) { return std::pow(10.0, 3 * (rank % 7)) / 3.0; }

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof(double)) == 0; }

TEST(Communicator, sums_in_the_order_of_ranks) {
  const Communicator& ranks = all_ranks();
  double in_order = number_of(0), negative = -number_of(0);
  for (int rank = 1; rank < ranks.count(); ++rank) {
    in_order += number_of(rank);
    negative += -number_of(rank);
  }
  const double mine = number_of(ranks.rank());
  EXPECT_TRUE(same_bits(ranks.sum(mine), in_order));
  const std::vector<double> both = ranks.sum(std::vector<double>{mine, -mine});
  EXPECT_TRUE(same_bits(both[0], in_order));
  EXPECT_TRUE(same_bits(both[1], negative));
  EXPECT_TRUE(ranks.sum(std::vector<double>()).empty());
}

TEST(Communicator, least_and_largest_keep_what_is_no_number) {
  const Communicator& ranks = all_ranks();
  const int last = ranks.count() - 1;
  EXPECT_EQ(ranks.min(-double(ranks.rank())), -last);
  EXPECT_EQ(ranks.max(double(ranks.rank())), last);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int where = 0; where <= last; ++where) {
    const double mine = ranks.rank() == where ? nan : 1.0;
    EXPECT_TRUE(std::isnan(ranks.max(mine)));
    EXPECT_TRUE(std::isnan(ranks.min(mine)));
    EXPECT_TRUE(std::isnan(ranks.sum(mine)));
  }
}

TEST(Communicator, counts_those_before) {
  const Communicator& ranks = all_ranks();
  const Communicator::Counts counts = ranks.count_all(10 + ranks.rank());
  const int before = ranks.rank(), all = ranks.count();
  EXPECT_EQ(counts.before, 10 * before + before * (before - 1) / 2);
  EXPECT_EQ(counts.all, 10 * all + all * (all - 1) / 2);
}

TEST(Communicator, gathers_at_rank_0_in_order) {
  const Communicator& ranks = all_ranks();
  const auto text_of = [](int rank) { return std::string(std::size_t(rank) * 100000, 'a' + rank); };
  std::vector<int> visited;
  ranks.gather(text_of(ranks.rank()), [&](int rank, const std::string& bytes) {
    EXPECT_EQ(bytes, text_of(rank));
    visited.push_back(rank);
  });
  std::vector<int> expected;
  for (int rank = 0; ranks.rank() == 0 && rank < ranks.count(); ++rank) expected.push_back(rank);
  EXPECT_EQ(visited, expected);
}

TEST(Communicator, broadcasts_what_rank_0_has) {
  const Communicator& ranks = all_ranks();
  std::string bytes = ranks.rank() == 0 ? std::string("a\0b", 3) : std::string("something longer");
  ranks.broadcast(bytes);
  EXPECT_EQ(bytes, std::string("a\0b", 3));
  bytes = ranks.rank() == 0 ? "" : "more";
  ranks.broadcast(bytes);
  EXPECT_EQ(bytes, "");
}

}  // namespace
}  // namespace peristat::tests
