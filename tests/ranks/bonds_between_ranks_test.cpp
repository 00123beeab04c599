#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/ranks/distribute.hpp"
#include "solvers/ranks/part_bonds.hpp"
#include "src/connectivity/crack.hpp"
#include "src/geometry/counts_bond.hpp"
#include "src/geometry/slab.hpp"
#include "tests/bodies.hpp"
#include "tests/ranks/bodies_on_ranks.hpp"
#include "tests/ranks/on_ranks.hpp"

namespace peristat::tests {
namespace {

using Ends = std::pair<GlobalIndex, GlobalIndex>;

/// The body as one rank has it, and this rank's part of it.
struct Both {
  Both(const RanksBody& body, SurfaceCorrection surface, const std::vector<Crack>& cracks = {})
      : whole(make_points(body.lattice)), part(make_part(body, surface)) {
    const BondSetting setting = body.setting();
    Bonds all = make_bonds(whole, surface, setting, 1);
    Bonds here = make_bonds(part, surface, setting, all_ranks(), 1);
    cut_of_whole = cut_bonds(all, whole, cracks);
    cut_of_part = cut_bonds(here, part.points, cracks);
    of_whole = std::move(all);
    of_part = std::move(here);
  }

  static Part make_part(const RanksBody& body, SurfaceCorrection surface) {
    Part slab = make_slab(body.lattice, all_ranks());
    const double reach = reach_of_bonds(slab.points, surface, body.setting(), all_ranks());
    return distribute(std::move(slab), body.setting().horizon, reach, all_ranks(), 1);
  }

  /// Numbers of the ends of a bond in the whole body, the lower one first.
  [[nodiscard]] Ends ends(Index i, Index j) const {
    return std::minmax({part.number[std::size_t(i)], part.number[std::size_t(j)]});
  }

  Points whole;
  Part part;
  CutBonds cut_of_whole, cut_of_part;
  Bonds of_whole, of_part;
};

/// What ranks know of bonds between two of them.
std::map<Ends, std::vector<double>> of_shared_bonds(
    const Both& both, const std::function<double(Index, Index, Offset)>& value) {
  std::vector<double> mine;
  for_each_bond(both.of_part, [&](Index i, Index j, Offset bond) {
    if (!both.part.is_ghost(j)) return;
    const auto [low, high] = both.ends(i, j);
    mine.insert(mine.end(), {double(low), double(high), value(i, j, bond)});
  });
  std::map<Ends, std::vector<double>> told;
  const double most = all_ranks().max(double(mine.size()));
  mine.resize(std::size_t(most), -1.0);
  const std::vector<double> all = all_ranks().all_of(mine);
  for (std::size_t k = 0; k < all.size(); k += 3) {
    if (all[k] < 0.0) continue;
    told[{GlobalIndex(all[k]), GlobalIndex(all[k + 1])}].push_back(all[k + 2]);
  }
  return told;
}

/// Expects both ranks of every bond between two to know the same of it, to the last bit.
void expect_agreement(const std::map<Ends, std::vector<double>>& told) {
  EXPECT_EQ(told.empty(), all_ranks().count() == 1);
  for (const auto& [ends, values] : told) {
    EXPECT_EQ(values.size(), 2u) << ends.first << " " << ends.second;
    EXPECT_EQ(values.front(), values.back()) << ends.first << " " << ends.second;
  }
}

TEST(BondsBetweenRanks, have_the_same_bits_on_both) {
  for (const RanksBody& body : {bar(), plate_with_hole(), wide_layers(), block()}) {
    for (const auto surface : {SurfaceCorrection::none, SurfaceCorrection::energy}) {
      SCOPED_TRACE(body.name);
      const Both both(body, surface);
      const Bonds& bonds = both.of_part;
      expect_agreement(of_shared_bonds(
          both, [&](Index, Index, Offset bond) { return bonds.inverse_length(bond); }));
      expect_agreement(
          of_shared_bonds(both, [&](Index, Index, Offset bond) { return bonds.weight(bond); }));
      for (const auto& [ends, counted] : of_shared_bonds(both, [&](Index i, Index j, Offset) {
             return double(counts_bond(both.part.points, i, j));
           })) {
        EXPECT_EQ(counted.front() + counted.back(), 1.0);
      }
    }
  }
}

/// Expects the bonds of a part to be those of the whole body, of its points.
void expect_bonds_of_whole(const Both& both) {
  std::vector<Ends> expected, found;
  std::vector<char> is_here(both.whole.volume.size(), 0);
  for (Index i = 0; i < both.part.owned; ++i) {
    is_here[std::size_t(both.part.number[std::size_t(i)])] = 1;
  }
  for_each_bond(both.of_whole, [&](Index i, Index j, Offset) {
    if (is_here[std::size_t(i)] || is_here[std::size_t(j)]) expected.emplace_back(i, j);
  });
  for_each_bond(both.of_part, [&](Index i, Index j, Offset) { found.push_back(both.ends(i, j)); });
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
}

TEST(PreCracks, cut_the_bonds_that_one_rank_cuts) {
  const std::vector<Crack> in_plane{CrackSegment{{0.3, 1.55, 0.0}, {1.15, 1.5, 0.0}},
                                    CrackSegment{{1.3, 0.35, 0.0}, {1.3, 1.15, 0.0}}};
  const std::vector<Crack> in_space{
      CrackPolygon{{{0.3, 0.3, 0.66}, {1.1, 0.3, 0.7}, {1.1, 0.62, 0.7}, {0.3, 0.62, 0.66}}}};
  for (const auto& [body, cracks] :
       {std::pair(plate_with_hole(), in_plane), std::pair(block(), in_space)}) {
    SCOPED_TRACE(body.name);
    const Both both(body, SurfaceCorrection::none, cracks);
    EXPECT_GT(both.cut_of_whole.ends.size(), 20u);
    expect_bonds_of_whole(both);
    double cut = 0.0;
    for (const auto& [i, j] : both.cut_of_part.ends) cut += counts_bond(both.part.points, i, j);
    EXPECT_EQ(all_ranks().sum(cut), double(both.cut_of_whole.ends.size()));
    for (Index i = 0; i < both.part.owned; ++i) {
      const double expected =
          both.cut_of_whole.weight[std::size_t(both.part.number[std::size_t(i)])];
      EXPECT_NEAR(both.cut_of_part.weight[std::size_t(i)], expected, 1e-12 * expected);
    }
  }
}

}  // namespace
}  // namespace peristat::tests
