#include "src/parallel/sums.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/ranks/distribute.hpp"
#include "solvers/ranks/make_index_map.hpp"
#include "src/geometry/slab.hpp"
#include "src/parallel/index_map.hpp"
#include "tests/ranks/bodies_on_ranks.hpp"
#include "tests/ranks/on_ranks.hpp"

namespace peristat::tests {
namespace {

TEST(Sums, count_each_point_once_whatever_ghosts_have) {
  const Communicator& ranks = all_ranks();
  const RanksBody body = plate_with_hole();
  const double horizon = body.setting().horizon;
  const Part part = distribute(make_slab(body.lattice, ranks), horizon, horizon, ranks, 1);
  const IndexMap index_map = make_index_map(part, ranks);
  const Sums sums(index_map, 2);
  std::vector<double> ones(part.points.reference.size(), std::nan(""));
  std::fill_n(ones.begin(), sums.own(ones.size()), 1.0);
  const double dofs = 2.0 * double(part.whole);
  EXPECT_EQ(sums.dot(ones, ones), dofs);
  EXPECT_NEAR(sums.norm(ones), std::sqrt(dofs), 1e-13 * dofs);
  EXPECT_EQ(sums.largest_of_all(double(ranks.rank())), double(ranks.count() - 1));
}

TEST(Sums, keep_norms_whose_squares_vanish) {
  const Communicator& ranks = all_ranks();
  const RanksBody body = bar();
  const double horizon = body.setting().horizon;
  const Part part = distribute(make_slab(body.lattice, ranks), horizon, horizon, ranks, 1);
  const IndexMap index_map = make_index_map(part, ranks);
  const std::vector<double> small(part.points.reference.size(), 1e-200);
  const double expected = 1e-200 * std::sqrt(double(part.whole));
  EXPECT_NEAR(Sums(index_map, 1).norm(small), expected, 1e-13 * expected);
}

TEST(Sums, are_plain_sums_of_a_whole_body) {
  const std::vector<double> v{3.0, 4.0};
  const Sums sums(whole_body(), 2);
  EXPECT_EQ(sums.norm(v), 5.0);
  EXPECT_EQ(sums.dot(v, v), 25.0);
  EXPECT_EQ(sums.own(2), 2u);
}

}  // namespace
}  // namespace peristat::tests
