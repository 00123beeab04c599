#include "assembly/terms/damage.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "solvers/ranks/distribute.hpp"
#include "solvers/ranks/make_index_map.hpp"
#include "solvers/ranks/part_bonds.hpp"
#include "src/connectivity/fragments.hpp"
#include "src/connectivity/free_motion.hpp"
#include "src/geometry/slab.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"
#include "tests/bodies.hpp"
#include "tests/ranks/bodies_on_ranks.hpp"
#include "tests/ranks/on_ranks.hpp"

namespace peristat::tests {
namespace {

/// Softens over a wide range of stretches, so that many bonds are somewhere in it.
BondPotential softening(const BondSetting& setting) {
  return Degraded<TanhDegradation>{micromodulus(3.0, setting), TanhDegradation{0.01, 0.05, 3.0}};
}

using Ends = std::pair<GlobalIndex, GlobalIndex>;

/// The body as one rank has it, and this rank's part of it.
struct Both {
  Both(const RanksBody& body, SurfaceCorrection surface)
      : whole(make_points(body.lattice)), part(make_part(body, surface)) {
    const BondSetting setting = body.setting();
    Bonds all = make_bonds(whole, surface, setting, 1);
    Bonds here = make_bonds(part, surface, setting, all_ranks(), 1);
    of_whole = Model(std::move(all), softening(setting));
    of_part = Model(std::move(here), softening(setting));
    index_map = std::make_unique<IndexMap>(make_index_map(part, all_ranks()));
  }

  static Part make_part(const RanksBody& body, SurfaceCorrection surface) {
    Part slab = make_slab(body.lattice, all_ranks());
    const double reach = reach_of_bonds(slab.points, surface, body.setting(), all_ranks());
    return distribute(std::move(slab), body.setting().horizon, reach, all_ranks(), 1);
  }

  [[nodiscard]] std::vector<double> of_points_here(const std::vector<double>& of_all) const {
    const auto d = std::size_t(part.points.dimension);
    std::vector<double> result;
    for (const GlobalIndex number : part.number) {
      const auto first = of_all.begin() + std::ptrdiff_t(std::size_t(number) * d);
      result.insert(result.end(), first, first + std::ptrdiff_t(d));
    }
    return result;
  }

  /// Numbers of the ends of a bond in the whole body, the lower one first.
  [[nodiscard]] Ends ends(Index i, Index j) const {
    return std::minmax({part.number[std::size_t(i)], part.number[std::size_t(j)]});
  }

  Points whole;
  Part part;
  Model of_whole, of_part;
  std::unique_ptr<IndexMap> index_map;
};

/// What ranks know of bonds between two of them.
std::map<Ends, std::vector<double>> of_shared_bonds(
    const Both& both, const std::function<double(Index, Index, Offset)>& value) {
  std::vector<double> mine;
  for_each_bond(both.of_part.bonds(), [&](Index i, Index j, Offset bond) {
    if (!both.part.is_ghost(j)) return;
    const auto [low, high] = both.ends(i, j);
    mine.insert(mine.end(), {double(low), double(high), value(i, j, bond)});
  });
  std::map<Ends, std::vector<double>> told;
  const std::vector<double> all = concatenated(all_ranks(), mine);
  for (std::size_t k = 0; k < all.size(); k += 3) {
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

TEST(DamageOfParts, grows_as_that_of_the_whole_body) {
  constexpr double round_off = 1e-12;
  for (const RanksBody& body :
       {bar(), three_points(), short_bar(), strip(), plate_with_hole(), block()}) {
    SCOPED_TRACE(body.name);
    const Both both(body, SurfaceCorrection::volume);
    Assembler all(both.whole, both.of_whole, 1);
    Assembler here(both.part.points, both.of_part, 1, *both.index_map);
    History of_all = all.initial_history(), of_part = here.initial_history();
    Index breaking = 0;
    for (int pass = 0; pass < 4; ++pass) {
      const std::vector<double> u =
          Random(unsigned(5 + pass))
              .vector(both.whole.reference.size(), (0.02 + 0.02 * pass) * both.whole.spacing);
      const std::vector<double> mine = both.of_points_here(u);
      const DamageGrowth expected = all.growth({u, of_all}), found = here.growth({mine, of_part});
      EXPECT_EQ(found.degrading, expected.degrading);
      EXPECT_EQ(found.breaking, expected.breaking);
      EXPECT_NEAR(found.utilisation, expected.utilisation, round_off * expected.utilisation);
      std::vector<double> forces(u.size()), forces_here(mine.size());
      const Evaluation committed = all.commit(u, of_all, forces);
      const Evaluation committed_here = here.commit(mine, of_part, forces_here);
      EXPECT_EQ(committed_here.growth.degrading, expected.degrading);
      EXPECT_EQ(committed_here.growth.breaking, expected.breaking);
      EXPECT_NEAR(committed_here.energy, committed.energy, round_off * committed.energy);
      const std::vector<double> expected_forces = both.of_points_here(forces);
      for (std::size_t k = 0; k < std::size_t(both.part.owned) * both.whole.dimension; ++k) {
        EXPECT_NEAR(forces_here[k], expected_forces[k], round_off * largest(forces));
      }
      breaking += expected.breaking;

      std::vector<double> damage(both.whole.volume.size()), damage_here(both.part.number.size());
      const DamageState state = all.assess(of_all, {}, damage);
      const DamageState state_here = here.assess(of_part, {}, damage_here);
      EXPECT_EQ(state_here.broken_bonds, state.broken_bonds);
      EXPECT_NEAR(state_here.dissipated_energy, state.dissipated_energy,
                  round_off * state.dissipated_energy);
      EXPECT_NEAR(state_here.max_damage, state.max_damage, round_off);
      for (Index i = 0; i < both.part.owned; ++i) {
        EXPECT_NEAR(damage_here[std::size_t(i)],
                    damage[std::size_t(both.part.number[std::size_t(i)])], round_off);
      }
      const std::span<const double> stretches = bond_stretches(both.of_part, of_part);
      expect_agreement(of_shared_bonds(
          both, [&](Index, Index, Offset bond) { return stretches[std::size_t(bond)]; }));
    }
    EXPECT_GT(breaking, 0);
  }
}

/// What is broken of the whole body and, likewise, of the part.
struct Broken {
  template <class Drop>
  Broken(const Both& both, const Drop& drop) {
    for_each_bond(both.of_whole.bonds(), [&](Index i, Index j, Offset) {
      of_whole.push_back(drop(both.whole, i, j, Ends{i, j}));
    });
    for_each_bond(both.of_part.bonds(), [&](Index i, Index j, Offset) {
      of_part.push_back(drop(both.part.points, i, j, both.ends(i, j)));
    });
  }
  std::vector<char> of_whole, of_part;
};

/// A number from 0 to 1 for each bond, the same on all ranks.
double chance(const Ends& ends, std::uint64_t seed) {
  std::uint64_t bits =
      (std::uint64_t(ends.first) * 1'000'003u + std::uint64_t(ends.second)) * 7u + seed;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
  return double((bits ^ (bits >> 31)) >> 11) * 0x1p-53;
}

/// Each of these points slides along a direction of its own. Its degree of freedom comes after
/// those of the points, in the order of `among`: the same on all ranks.
std::vector<FreeHandle> slides_of(const std::vector<GlobalIndex>& numbers, std::size_t dofs,
                                  const std::vector<GlobalIndex>& among) {
  std::vector<FreeHandle> slides;
  for (std::size_t k = 0; k < among.size(); ++k) {
    const GlobalIndex number = among[k];
    const auto place = std::find(numbers.begin(), numbers.end(), number);
    if (place == numbers.end()) continue;
    const double angle = 0.3 + 0.1 * double(number);
    const HeldMotion motion{Index(place - numbers.begin()), {std::cos(angle), std::sin(angle), 0}};
    slides.push_back({dofs + k, motion, true});
  }
  return slides;
}

/// @param sliding numbers of points on rollers
void expect_same_fragments(const Both& both, const Broken& broken, std::vector<char> prescribed,
                           const std::vector<double>& u,
                           const std::vector<GlobalIndex>& sliding = {}) {
  const auto d = std::size_t(both.whole.dimension);
  std::vector<char> prescribed_here;
  for (const GlobalIndex number : both.part.number) {
    for (std::size_t c = 0; c < d; ++c) {
      prescribed_here.push_back(prescribed[std::size_t(number) * d + c]);
    }
  }
  Holding holding{prescribed}, holding_here{prescribed_here};
  std::vector<GlobalIndex> all(both.whole.volume.size());
  std::iota(all.begin(), all.end(), GlobalIndex(0));
  holding.handles = slides_of(all, prescribed.size(), sliding);
  holding_here.handles = slides_of(both.part.number, prescribed_here.size(), sliding);
  prescribed.resize(prescribed.size() + sliding.size());
  prescribed_here.resize(prescribed_here.size() + sliding.size());
  const Fragments expected =
      find_fragments(both.whole, both.of_whole.bonds(), broken.of_whole, prescribed, u, holding);
  const Fragments found =
      find_fragments(both.part.points, both.of_part.bonds(), broken.of_part, prescribed_here,
                     both.of_points_here(u), holding_here, *both.index_map);
  EXPECT_EQ(found.count, expected.count);
  for (const FreeHandle& slide : holding_here.handles) {
    if (slide.moved_by.member >= both.part.owned) continue;
    const GlobalIndex number = both.part.number[std::size_t(slide.moved_by.member)];
    for (const FreeHandle& there : holding.handles) {
      if (there.moved_by.member != Index(number)) continue;
      EXPECT_EQ(int(found.pinned[slide.dof]), int(expected.pinned[there.dof])) << number;
    }
  }
  std::vector<Index> loose;
  for (Index i = 0; i < both.part.owned; ++i) {
    const auto there = std::size_t(both.part.number[std::size_t(i)]);
    EXPECT_EQ(found.piece[std::size_t(i)], expected.piece[there]) << there;
    for (std::size_t c = 0; c < d; ++c) {
      EXPECT_EQ(int(found.pinned[std::size_t(i) * d + c]), int(expected.pinned[there * d + c]))
          << there << " along " << c;
    }
    if (std::binary_search(expected.loose.begin(), expected.loose.end(), Index(there))) {
      loose.push_back(i);
    }
  }
  EXPECT_EQ(found.loose, loose);
}

/// All components of points whose last coordinate is low are held.
std::vector<char> held_below(const Points& points, double height) {
  const auto d = std::size_t(points.dimension);
  std::vector<char> held(points.reference.size(), 0);
  for (std::size_t k = 0; k < held.size(); k += d) {
    if (points.reference[k + d - 1] > height) continue;
    std::fill_n(held.begin() + std::ptrdiff_t(k), d, char(1));
  }
  return held;
}

TEST(FragmentsOnRanks, are_those_of_one_rank) {
  for (const RanksBody& body : {bar(), short_bar(), strip(), plate_with_hole(), block()}) {
    const Both both(body, SurfaceCorrection::none);
    const std::size_t d = std::size_t(both.whole.dimension);
    const std::vector<char> held = held_below(both.whole, 0.45);
    const std::vector<double> u =
        Random(9).vector(both.whole.reference.size(), 0.1 * both.whole.spacing);
    const auto across = [&](double at, std::size_t axis) {
      return [at, axis, d](const Points& points, Index i, Index j, const Ends&) {
        const double a = points.reference[std::size_t(i) * d + axis];
        const double b = points.reference[std::size_t(j) * d + axis];
        return char((a < at) != (b < at));
      };
    };
    std::vector<GlobalIndex> upper_points;
    for (std::size_t i = 0; i < both.whole.volume.size(); ++i) {
      if (held[i * d] == 0) upper_points.push_back(GlobalIndex(i));
    }
    const auto unbroken = [](const Points&, Index, Index, const Ends&) { return char(0); };
    {
      SCOPED_TRACE(body.name + ", whole and held");
      expect_same_fragments(both, Broken(both, unbroken), held, u);
    }
    {
      SCOPED_TRACE(body.name + ", whole and free");
      expect_same_fragments(both, Broken(both, unbroken), std::vector<char>(held.size(), 0), u);
    }
    for (std::size_t axis = 0; axis < d; ++axis) {
      SCOPED_TRACE(body.name + ", cut across axis " + std::to_string(axis));
      expect_same_fragments(both, Broken(both, across(0.72, axis)), held, u);
    }
    for (const double share : {0.5, 0.8, 0.9, 0.97, 1.0}) {
      SCOPED_TRACE(body.name + ", bonds broken at random " + std::to_string(share));
      const auto at_random = [&](const Points&, Index, Index, const Ends& ends) {
        return char(chance(ends, 3) < share);
      };
      expect_same_fragments(both, Broken(both, at_random), held, u);
      expect_same_fragments(both, Broken(both, at_random), held,
                            std::vector<double>(u.size(), 0.0));
      if (d == 2) expect_same_fragments(both, Broken(both, at_random), held, u, upper_points);
    }
  }
}

TEST(FragmentsOnRanks, tell_all_ranks_what_may_move) {
  const RanksBody body = plate_with_hole();
  const Both both(body, SurfaceCorrection::none);
  const std::vector<char> held(both.whole.reference.size(), 0);
  const std::vector<char> held_here(both.part.points.reference.size(), 0);
  const std::vector<FreeMotion> expected = free_motions(both.whole, both.of_whole.bonds(), {held});
  const std::vector<FreeMotion> found =
      free_motions(both.part.points, both.of_part.bonds(), {held_here}, *both.index_map);
  EXPECT_EQ(found.size(), expected.size());
  EXPECT_EQ(expected.size(), 1u);
  for (std::size_t k = 0; k < std::min(found.size(), expected.size()); ++k) {
    EXPECT_EQ(found[k].points, expected[k].points);
    EXPECT_EQ(found[k].example, expected[k].example);
    EXPECT_EQ(found[k].place, expected[k].place);
    EXPECT_EQ(found[k].motions, expected[k].motions);
  }
}

}  // namespace
}  // namespace peristat::tests
