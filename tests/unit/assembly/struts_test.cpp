#include "assembly/terms/struts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <numeric>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/terms/damage.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::BoxSetting;

constexpr double critical = 1e-3, spacing = 0.1;

BoxSetting brittle_box() {
  BoxSetting box = tests::small_box(2);
  box.spacing = spacing;
  box.extent = {12, 10, 0};
  box.horizon_ratio = 3.015;
  box.potential = [](double modulus) -> BondPotential {
    return Degraded<CriticalStretch>{modulus, {critical}};
  };
  return box;
}

/// Displacement at a place over the elongation at which the longest bond breaks.
using Moves = std::function<std::array<double, 2>(double x, double y)>;

/// The upper half moves up and to the right: bonds that slant to the left are shortened, or hardly
/// stretched.
std::array<double, 2> upper_half(double, double y) {
  return y > 0.5 ? std::array{3.0, 3.0} : std::array{0.0, 0.0};
}

/// A plate in parts that have moved as rigid bodies.
struct Torn {
  BoxBody body;
  std::vector<double> displacement;

  explicit Torn(Points points, const Moves& moves = upper_half)
      : body(std::move(points), brittle_box()), displacement(body.points.reference.size()) {
    for (std::size_t k = 0; k < displacement.size(); k += 2) {
      const auto moved = moves(body.points.reference[k], body.points.reference[k + 1]);
      for (std::size_t c = 0; c < 2; ++c) displacement[k + c] = 3.0 * spacing * critical * moved[c];
    }
    body.model.cut_struts(std::make_shared<const Struts>(body.points, body.model.bonds()));
  }
  [[nodiscard]] bool is_above(Index i) const {
    return body.points.reference[std::size_t(i) * 2 + 1] > 0.5;
  }

  using Ends = std::array<double, 4>;
  template <class Takes>
  [[nodiscard]] std::set<Ends> places(const Takes& takes) const {
    const Bonds& bonds = body.model.bonds();
    const std::vector<double>& at = body.points.reference;
    std::set<Ends> found;
    for (Index i = 0; i < bonds.points(); ++i) {
      for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
        const Index j = bonds.partner(i, bond);
        if (!takes(bond, i, j)) continue;
        std::array<std::array<double, 2>, 2> ends;
        for (std::size_t c = 0; c < 2; ++c) {
          ends[0][c] = at[std::size_t(i) * 2 + c];
          ends[1][c] = at[std::size_t(j) * 2 + c];
        }
        std::ranges::sort(ends);
        found.insert({ends[0][0], ends[0][1], ends[1][0], ends[1][1]});
      }
    }
    return found;
  }
  [[nodiscard]] std::set<Ends> across() const {
    return places([&](Offset, Index i, Index j) { return is_above(i) != is_above(j); });
  }
  /// A history after which the bonds that are stretched beyond what they bear are broken.
  [[nodiscard]] History by_stretch() const {
    Model whole = body.model;
    whole.cut_struts(nullptr);
    Assembler assembler(body.points, whole, 1);
    History history = assembler.initial_history();
    assembler.commit(displacement, history, {});
    return history;
  }
  [[nodiscard]] std::set<Ends> broken(const History& history) const {
    const std::vector<char> is = broken_bonds(body.model, history);
    return places([&](Offset bond, Index, Index) { return is[std::size_t(bond)] != 0; });
  }
  [[nodiscard]] std::set<Ends> struts(const History& history, int threads) const {
    const std::vector<Offset> found =
        body.model.struts()->find(*body.model.failing_bonds(), body.points, {displacement, history},
                                  body.model.failure_history(history), threads);
    return places(
        [&](Offset bond, Index, Index) { return std::ranges::binary_search(found, bond); });
  }
};

Points in_order(const std::vector<Index>& order) {
  Points points = tests::box_points(brittle_box());
  const std::vector<double> reference = points.reference;
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t c = 0; c < 2; ++c) {
      points.reference[2 * i + c] = reference[2 * std::size_t(order[i]) + c];
    }
  }
  points.sets.clear();
  return points;
}

Torn::Ends rounded(Torn::Ends ends) {
  for (double& place : ends) place = std::round(place / spacing * 1e3) / 1e3;
  return ends;
}

Points as_made() { return tests::box_points(brittle_box()); }

TEST(Struts, AreTheBondsThatSlantBackwardsAcrossAnOpenCrack) {
  const Torn torn(as_made());
  const History history = torn.by_stretch();
  const auto broken = torn.broken(history), across = torn.across();
  std::set<Torn::Ends> whole;
  std::ranges::set_difference(across, broken, std::inserter(whole, whole.end()));
  ASSERT_GT(broken.size(), 2 * whole.size());
  ASSERT_GT(whole.size(), 20u);
  for (const auto& [x, y, far_x, far_y] : whole) EXPECT_LT((far_x - x) * (far_y - y), 0.0);
  EXPECT_EQ(torn.struts(history, 1), whole);
}

TEST(Struts, AreNoneWhileTheFacesAreClose) {
  Torn torn(as_made());
  const History history = torn.by_stretch();
  ASSERT_FALSE(torn.struts(history, 1).empty());
  for (double& component : torn.displacement) component *= 0.1;  // the crack has closed again
  EXPECT_TRUE(torn.struts(history, 1).empty());
}

TEST(Struts, AreNoneWhereMostBondsAreWhole) {
  Torn torn(as_made());
  const Bonds& bonds = torn.body.model.bonds();
  // Of the bonds across, only upright ones are broken.
  std::vector<double> stretches(std::size_t(bonds.count()));
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner(i, bond);
      const double along = torn.body.points.reference[std::size_t(j) * 2] -
                           torn.body.points.reference[std::size_t(i) * 2];
      if (torn.is_above(i) != torn.is_above(j) && std::abs(along) < 0.5 * spacing) {
        stretches[std::size_t(bond)] = critical;
      }
    }
  }
  Assembler assembler(torn.body.points, torn.body.model, 1);
  const History history = assembler.history_of(stretches, assembler.initial_history());
  ASSERT_FALSE(torn.broken(history).empty());
  EXPECT_TRUE(torn.struts(history, 1).empty());
}

TEST(Struts, DependNeitherOnThreadsNorOnTheOrderOfPoints) {
  const Torn torn(as_made());
  const auto struts = torn.struts(torn.by_stretch(), 1);
  ASSERT_FALSE(struts.empty());
  EXPECT_EQ(torn.struts(torn.by_stretch(), 2), struts);
  EXPECT_EQ(torn.struts(torn.by_stretch(), 3), struts);
  std::vector<Index> order(std::size_t(torn.body.points.count()));
  std::iota(order.begin(), order.end(), Index(0));
  std::ranges::reverse(order);
  for (std::size_t i = 0; i + 7 < order.size(); i += 7) std::swap(order[i], order[i + 5]);
  const Torn other(in_order(order));
  EXPECT_EQ(other.struts(other.by_stretch(), 2), struts);
}

TEST(Struts, OfHalfOfASymmetricBodyAreThoseOfTheWhole) {
  const Moves moves = [](double x, double y) {
    return x > 0.6 ? std::array{3.1, y > 0.5 ? -2.9 : 2.9} : std::array{0.0, 0.0};
  };
  const Torn whole(as_made(), moves);
  Points upper = as_made();
  std::vector<double> reference, volume;
  for (Index i = 0; i < upper.count(); ++i) {
    const auto at = upper.position(i);
    if (at[1] < 0.5) continue;
    reference.insert(reference.end(), {at[0], at[1]});
    volume.push_back(upper.volume[std::size_t(i)]);
  }
  upper.reference = reference;
  upper.volume = volume;
  upper.sets.clear();
  add_images(upper, {{1, 0.5}}, {}, 3.5 * spacing);
  const Torn half(std::move(upper), moves);
  std::set<Torn::Ends> expected, with_images;
  for (const Torn::Ends& ends : whole.struts(whole.by_stretch(), 1)) {
    if (std::max(ends[1], ends[3]) > 0.5) expected.insert(rounded(ends));
  }
  for (const Torn::Ends& ends : half.struts(half.by_stretch(), 2)) {
    if (std::max(ends[1], ends[3]) > 0.5) with_images.insert(rounded(ends));
  }
  EXPECT_TRUE(std::ranges::any_of(
      expected, [](const Torn::Ends& ends) { return std::min(ends[1], ends[3]) < 5.0; }));
  EXPECT_EQ(with_images, expected);
}

TEST(Struts, FailInACommitThatCountsWhatTheyStored) {
  const Torn torn(as_made());
  Assembler assembler(torn.body.points, torn.body.model, 2);
  History history = assembler.initial_history();
  const History by_stretch = torn.by_stretch();
  const double stored = assembler.energy({torn.displacement, by_stretch}).energy;
  ASSERT_GT(stored, 0.0);
  const auto dissipated = [&](const History& of) {
    std::vector<double> damage(std::size_t(torn.body.points.count()));
    return assembler.assess(of, {}, damage).dissipated_energy;
  };
  std::vector<double> gradient(torn.displacement.size(), 1.0);
  const Evaluation found = assembler.commit(torn.displacement, history, gradient);
  EXPECT_EQ(std::size_t(found.growth.breaking), torn.across().size());
  EXPECT_EQ(torn.broken(history), torn.across());
  // The two halves are rigid and free of one another.
  EXPECT_NEAR(found.energy, 0.0, 1e-12 * stored);
  EXPECT_NEAR(tests::largest(gradient), 0.0, 1e-12 * stored / (spacing * critical));
  EXPECT_NEAR(found.growth.strut_energy, stored, 1e-12 * stored);
  // Work is stored or dissipated: what their law would have taken is no part of it.
  EXPECT_NEAR(dissipated(history) + found.released, dissipated(by_stretch) + stored,
              1e-12 * dissipated(history));
  EXPECT_TRUE(found.moves_equilibrium);
  const Evaluation again = assembler.commit(torn.displacement, history, {});
  EXPECT_EQ(again.growth.breaking, 0);
  EXPECT_FALSE(again.moves_equilibrium);
}

TEST(Struts, CountAsGrowthBeforeACommit) {
  const Torn torn(as_made());
  Assembler assembler(torn.body.points, torn.body.model, 1);
  const History history = torn.by_stretch();
  const auto struts = Index(torn.struts(history, 1).size());
  const DamageGrowth growth = assembler.growth({torn.displacement, history});
  EXPECT_EQ(growth.breaking, struts);
  EXPECT_EQ(growth.degrading, struts);
}

}  // namespace
}  // namespace peristat
