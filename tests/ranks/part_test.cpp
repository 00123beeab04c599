#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/ranks/distribute.hpp"
#include "solvers/ranks/ranks.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/slab.hpp"
#include "src/geometry/squared_distance.hpp"
#include "src/neighbourhood/horizon.hpp"
#include "src/parallel/communicator.hpp"
#include "src/parallel/ghost_exchange.hpp"
#include "tests/ranks/bodies_on_ranks.hpp"
#include "tests/ranks/on_ranks.hpp"

namespace peristat::tests {
namespace {

/// Expects the points of a part to be those of the whole body, to the last bit, with their sets.
void expect_points_of(const Part& part, const Points& whole) {
  const auto d = std::size_t(whole.dimension);
  EXPECT_EQ(part.whole, whole.count());
  EXPECT_EQ(part.number.size(), part.points.volume.size());
  for (Index i = 0; i < part.points.count(); ++i) {
    const auto here = std::size_t(i), there = std::size_t(part.number[here]);
    for (std::size_t c = 0; c < d; ++c) {
      EXPECT_EQ(part.points.reference[here * d + c], whole.reference[there * d + c]);
    }
    EXPECT_EQ(part.points.volume[here], whole.volume[there]);
    if (!whole.polygons.empty()) {
      EXPECT_EQ(part.points.polygons.of(here), whole.polygons.of(there));
    }
  }
  EXPECT_EQ(part.points.polygons.empty(), whole.polygons.empty());
  EXPECT_EQ(part.points.angle, whole.angle);
  EXPECT_EQ(part.points.sets.size(), whole.sets.size());
  for (const auto& [name, members] : whole.sets) {
    const auto found = part.points.sets.find(name);
    EXPECT_TRUE(found != part.points.sets.end()) << name;
    if (found == part.points.sets.end()) continue;
    std::vector<Index> expected;
    for (Index i = 0; i < part.points.count(); ++i) {
      const Index there = Index(part.number[std::size_t(i)]);
      if (std::binary_search(members.begin(), members.end(), there)) expected.push_back(i);
    }
    EXPECT_EQ(found->second, expected) << name;
  }
}

/// Rank that owns each point of the body, as all ranks tell.
std::vector<int> owners(const Part& part, const Communicator& ranks) {
  std::vector<double> owner(std::size_t(part.whole), 0.0), times(owner);
  for (Index i = 0; i < part.owned; ++i) {
    owner[std::size_t(part.number[std::size_t(i)])] = ranks.rank();
    times[std::size_t(part.number[std::size_t(i)])] = 1.0;
  }
  for (const double count : ranks.sum(times)) EXPECT_EQ(count, 1.0);
  const std::vector<double> all = ranks.sum(owner);
  return {all.begin(), all.end()};
}

/// Ghosts by looking at all pairs.
std::vector<GlobalIndex> ghosts_by_pairs(const Points& whole, const std::vector<int>& owner,
                                         int rank, double reach) {
  std::vector<GlobalIndex> ghosts;
  const double squared = std::pow(inclusive_radius(reach), 2);
  for (Index i = 0; i < whole.count(); ++i) {
    if (owner[std::size_t(i)] == rank) continue;
    bool near = false;
    for (Index j = 0; j < whole.count() && !near; ++j) {
      near = owner[std::size_t(j)] == rank &&
             squared_distance(whole.reference, whole.dimension, i, j) <= squared;
    }
    if (near) ghosts.push_back(i);
  }
  return ghosts;
}

TEST(Slab, is_a_part_of_what_one_rank_makes) {
  for (const RanksBody& body : all_bodies()) {
    SCOPED_TRACE(body.name);
    const Points whole = make_points(body.lattice);
    const Part slab = make_slab(body.lattice, all_ranks());
    expect_points_of(slab, whole);
    EXPECT_EQ(slab.owned, slab.points.count());
    static_cast<void>(owners(slab, all_ranks()));
    for (std::size_t i = 1; i < slab.number.size(); ++i) {
      EXPECT_EQ(slab.number[i], slab.number[i - 1] + 1);
    }
    EXPECT_EQ(slab.points.cross_section(), body.lattice.cross_section) << body.name;
  }
}

TEST(Slab, refuses_on_all_ranks_what_it_does_not_tell) {
  const auto key_of = [](const Lattice& lattice) {
    try {
      static_cast<void>(make_slab(lattice, all_ranks()));
    } catch (const InputError& error) {
      return std::string(error.key());
    }
    return std::string("none");
  };
  Lattice lattice = strip().lattice;
  EXPECT_EQ(key_of(lattice), "none");
  lattice.arrangement = Arrangement::blue_noise;
  EXPECT_EQ(key_of(lattice), "arrangement");
  lattice = strip().lattice;
  lattice.layers = {{"none", {0, 1}, 1, "x < 0"}};
  EXPECT_EQ(key_of(lattice), "layers[0].where");
  lattice = turned_plate().lattice;
  lattice.shapes[0].shape = Disk{{1.0, 1.0}, 0.8};
  EXPECT_EQ(key_of(lattice), "layers[0].thickness");  // as make_points
  lattice = strip().lattice;
  lattice.shapes.push_back({ShapeStep::Action::subtract, lattice.shapes[0].shape});
  EXPECT_EQ(key_of(lattice), "shapes");
}

TEST(Part, owns_each_point_once_and_sees_all_within_its_reach) {
  const Communicator& ranks = all_ranks();
  for (const RanksBody& body : all_bodies()) {
    for (const double horizons : {1.0, 2.0}) {
      SCOPED_TRACE(body.name);
      const double horizon = body.setting().horizon, reach = horizons * horizon;
      const Points whole = make_points(body.lattice);
      const Part part = distribute(make_slab(body.lattice, ranks), horizon, reach, ranks, 1);
      expect_points_of(part, whole);
      const auto first_ghost = part.number.begin() + part.owned;
      EXPECT_TRUE(std::is_sorted(part.number.begin(), first_ghost));
      const std::vector<int> owner = owners(part, ranks);
      const std::vector<GlobalIndex> ghosts(first_ghost, part.number.end());
      EXPECT_EQ(ghosts, ghosts_by_pairs(whole, owner, ranks.rank(), reach));
      EXPECT_EQ(part.owner.size(), ghosts.size());
      for (std::size_t k = 0; k < std::min(ghosts.size(), part.owner.size()); ++k) {
        EXPECT_EQ(part.owner[k], owner[std::size_t(ghosts[k])]);
      }
    }
  }
}

TEST(Part, may_have_no_point) {
  const Communicator& ranks = all_ranks();
  const RanksBody body = three_points();
  const double horizon = body.setting().horizon;
  const Part part = distribute(make_slab(body.lattice, ranks), horizon, horizon, ranks, 1);
  const bool empty = part.owned == 0;
  EXPECT_GE(ranks.sum(double(empty)), ranks.count() - 3);
  if (empty) {
    EXPECT_EQ(part.ghosts(), 0);
  }
}

TEST(Part, refuses_points_that_others_do_not_know) {
  Part part = make_slab(strip().lattice, all_ranks());
  part.points.neighbours.push_back({0, 1, 1.0, 1.0});
  if (all_ranks().count() > 1) {
    EXPECT_THROW(static_cast<void>(with_ghosts(part, 0.3, all_ranks())), std::logic_error);
  }
}

TEST(Part, has_about_an_equal_share_of_the_work) {
  const Communicator& ranks = all_ranks();
  for (const RanksBody& body : {bar(), plate_with_hole(), block()}) {
    const double horizon = body.setting().horizon;
    const Part part = distribute(make_slab(body.lattice, ranks), horizon, horizon, ranks, 1);
    const double mean = double(part.whole) / ranks.count();
    // Rows of a small body can't be cut in two; corners have a quarter of the neighbours.
    EXPECT_LT(part.owned, 1.4 * mean) << body.name;
    EXPECT_GT(part.owned, 0.6 * mean) << body.name;
  }
}

TEST(GhostExchange, brings_what_owners_have_and_counts_it) {
  const Communicator& ranks = all_ranks();
  const RanksBody body = plate_with_hole();
  const double horizon = body.setting().horizon;
  const Part part = distribute(make_slab(body.lattice, ranks), horizon, horizon, ranks, 1);
  const auto first_ghost = part.number.begin() + part.owned;
  const auto exchange = make_ghost_exchange(ranks, {part.number.begin(), first_ghost},
                                            {first_ghost, part.number.end()}, 2);
  for (const double factor : {1.0, -3.0}) {
    const auto value = [&](Index i, int c) {
      return factor * (10.0 * double(part.number[std::size_t(i)]) + c);
    };
    std::vector<double> values(2 * part.number.size(), 0.25);
    for (Index i = 0; i < part.owned; ++i) {
      for (int c = 0; c < 2; ++c) values[std::size_t(2 * i + c)] = value(i, c);
    }
    exchange->update(values.data());
    for (Index i = 0; i < part.points.count(); ++i) {
      for (int c = 0; c < 2; ++c) EXPECT_EQ(values[std::size_t(2 * i + c)], value(i, c));
    }
  }
  const Traffic traffic = exchange->traffic();
  EXPECT_EQ(traffic.exchanges, 2);
  const double pairs = double(std::set<int>(part.owner.begin(), part.owner.end()).size());
  EXPECT_EQ(ranks.sum(double(traffic.messages)), 2.0 * ranks.sum(pairs));
  EXPECT_EQ(ranks.sum(double(traffic.bytes)), 2.0 * 16.0 * ranks.sum(double(part.ghosts())));
}

}  // namespace
}  // namespace peristat::tests
