// Sums along runs of points with alike bonds: the same as bond by bond.
#include "src/neighbourhood/bond_runs.hpp"

#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "src/potentials/any_law.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::BoxSetting;
using tests::Random;

constexpr double onset = 0.05, critical = 0.2;

BondPotential brittle(double modulus) { return Degraded<CriticalStretch>{modulus, {critical}}; }
BondPotential softening(double modulus) {
  return Degraded<TanhDegradation>{modulus, {onset, critical, 20.0}};
}
BondPotential whole(double modulus) { return Harmonic{modulus}; }

struct Lattice {
  int dimension;
  double perturbation;  ///< of positions in spacings: every bond of a run has its own kind
};

BoxSetting rows_of(const Lattice& lattice, const std::function<BondPotential(double)>& potential) {
  const int dimension = lattice.dimension;
  BoxSetting box = tests::small_box(dimension);
  box.perturbation = lattice.perturbation;
  box.extent = dimension == 1   ? std::array{300, 0, 0}  // longer than a piece
               : dimension == 2 ? std::array{21, 14, 0}
                                : std::array{14, 8, 15};
  box.quadrature = {VolumeCorrection::linear, SurfaceCorrection::none};
  box.potential = potential;
  return box;
}

/// A box with a hole, in which no bond crosses a line.
BoxBody cut_body(const BoxSetting& box) {
  Points points = tests::box_points(box);
  for (double& x : points.reference) x += 1234.5 * box.spacing;  // positions have round-off
  BoxBody body(std::move(points), box);
  const double h = box.spacing;
  body.remove_bonds([&](Index i, Offset bond) {
    const auto x = [&](Index p, int c) {
      return body.points.reference[std::size_t(p * box.dimension + c)];
    };
    const Index j = body.model.bonds().partner(i, bond);
    const bool crosses = (x(i, 0) < 1245.5 * h) != (x(j, 0) < 1245.5 * h);
    return crosses && (box.dimension == 1 ? false : x(i, 1) < 1237.5 * h);
  });
  return body;
}

Model one_by_one(Model model) {
  model.sum_one_by_one();
  return model;
}

/// Largest difference over the largest entry.
double difference(const std::vector<double>& one, const std::vector<double>& other) {
  double found = 0.0;
  for (std::size_t k = 0; k < one.size(); ++k) found = std::max(found, std::abs(one[k] - other[k]));
  return found / tests::largest(other);
}

/// A state in which bonds are stretched up to some ten per cent near one end, and hardly elsewhere.
std::vector<double> stretched(const Points& points, std::uint64_t seed, double most) {
  std::vector<double> u = Random(seed).vector(points.reference.size());
  for (Index i = 0; i < points.count(); ++i) {
    const double x = (points.reference[std::size_t(i) * points.dimension] - points.reference[0]) /
                     points.spacing;
    const double share = x < 8.0 ? most : 0.002;
    for (int c = 0; c < points.dimension; ++c)
      u[std::size_t(i) * points.dimension + c] *= share * points.spacing;
  }
  return u;
}

struct Sums {
  Evaluation found;
  double energy = 0.0;
  std::vector<double> forces, product, projected;
  std::vector<double> in_single, projected_in_single;  ///< the products
  std::vector<double> diagonal, projected_diagonal;
};

Sums sums_of(Assembler& assembler, const StateView& at, std::size_t dofs) {
  Sums sums;
  sums.forces.resize(dofs);
  sums.found = assembler.gradient(at, sums.forces);
  sums.energy = assembler.energy(at).energy;
  const std::vector<double> v = Random(3).vector(dofs);
  sums.product.resize(dofs);
  sums.projected.resize(dofs);
  assembler.product(at, v, sums.product);
  assembler.product(at, v, sums.projected, 1.0);
  const std::size_t entries = dofs * std::size_t(assembler.points().dimension);
  sums.diagonal.assign(entries, 7.0);
  sums.projected_diagonal.assign(entries, 7.0);
  assembler.find_diagonal(at, 0.0, sums.diagonal);
  assembler.find_diagonal(at, 1.0, sums.projected_diagonal);
  StateView roughly = at;
  roughly.precision = Precision::single;
  sums.in_single.resize(dofs);
  sums.projected_in_single.resize(dofs);
  assembler.product(roughly, v, sums.in_single);
  assembler.product(roughly, v, sums.projected_in_single, 1.0);
  return sums;
}

void expect_equal(const Sums& one, const Sums& other) {
  EXPECT_NEAR(one.found.energy, other.found.energy, 1e-13 * other.found.energy);
  EXPECT_NEAR(one.energy, other.energy, 1e-13 * other.energy);
  EXPECT_LT(difference(one.forces, other.forces), 1e-12);
  EXPECT_LT(difference(one.product, other.product), 1e-12);
  EXPECT_LT(difference(one.projected, other.projected), 1e-12);
  EXPECT_LT(difference(one.diagonal, other.diagonal), 1e-12);
  EXPECT_LT(difference(one.projected_diagonal, other.projected_diagonal), 1e-12);
  EXPECT_LT(difference(one.in_single, other.product), 1e-6);
  EXPECT_LT(difference(one.projected_in_single, other.projected), 1e-6);
  EXPECT_EQ(other.in_single, other.product);
  EXPECT_EQ(one.found.degenerate, other.found.degenerate);
}

class BondRunsIn : public testing::TestWithParam<Lattice> {};
INSTANTIATE_TEST_SUITE_P(Lattices, BondRunsIn,
                         testing::Values(Lattice{1, 0.0}, Lattice{2, 0.0}, Lattice{3, 0.0},
                                         Lattice{1, 0.01}, Lattice{2, 0.01}, Lattice{3, 0.01}),
                         [](const auto& at) {
                           return std::to_string(at.param.dimension) + "D" +
                                  (at.param.perturbation > 0.0 ? "_perturbed" : "");
                         });

TEST_P(BondRunsIn, SumsAreThoseOfSingleBonds) {
  for (const auto& potential : {whole, brittle, softening}) {
    const BoxBody body = cut_body(rows_of(GetParam(), potential));
    ASSERT_GT(share_in_runs(body.points, body.model.bonds(), 1), BondRuns::least_share);
    const Model list = one_by_one(body.model);
    for (const int threads : {1, 2, 3}) {
      Assembler along(body.points, body.model, threads), single(body.points, list, threads);
      History history = along.initial_history();
      for (const double most : {0.01, 0.3}) {
        const std::vector<double> u = stretched(body.points, 5, most);
        expect_equal(sums_of(along, {u, history}, u.size()),
                     sums_of(single, {u, history}, u.size()));
        // Searches hold the damage, too.
        const StateView held{u, history, Damage::held};
        expect_equal(sums_of(along, held, u.size()), sums_of(single, held, u.size()));
      }
    }
  }
}

TEST_P(BondRunsIn, DamageIsThatOfSingleBonds) {
  for (const auto& potential : {brittle, softening}) {
    const BoxBody body = cut_body(rows_of(GetParam(), potential));
    const Model list = one_by_one(body.model);
    Assembler along(body.points, body.model, 2), single(body.points, list, 2);
    History one = along.initial_history(), other = single.initial_history();
    Index degraded = 0;
    // Damage begins, goes on in damaged rows, begins in others, and unloads.
    for (const auto& [seed, most] : {std::pair{5, 0.2}, {6, 0.4}, {5, 0.01}}) {
      std::vector<double> u = stretched(body.points, std::uint64_t(seed), most);
      if (seed == 6) u[u.size() / 2] += 0.7 * body.points.spacing;
      std::vector<double> forces(u.size()), forces_of_single(u.size());
      const Evaluation committed = along.commit(u, one, forces),
                       expected = single.commit(u, other, forces_of_single);
      EXPECT_EQ(committed.growth.degrading, expected.growth.degrading);
      EXPECT_EQ(committed.growth.breaking, expected.growth.breaking);
      EXPECT_NEAR(committed.energy, expected.energy, 1e-12 * expected.energy);
      EXPECT_LT(difference(forces, forces_of_single), 1e-12);
      degraded += expected.growth.degrading;
      // The look at single bonds finds the very stretches that were committed.
      EXPECT_EQ(along.growth(StateView{u, one}).degrading, 0);
      const auto kept = body.model.failure_history(one),
                 kept_by_single = body.model.failure_history(other);
      ASSERT_EQ(kept.size(), kept_by_single.size());
      for (std::size_t k = 0; k < kept.size(); ++k) ASSERT_NEAR(kept[k], kept_by_single[k], 1e-12);
      // Just at their largest stretches bonds may load or unload.
      for (double& entry : u) entry *= 0.98;
      expect_equal(sums_of(along, {u, one}, u.size()), sums_of(single, {u, other}, u.size()));
    }
    EXPECT_GT(degraded, 0);
    // A history from before the damage is not confused with the present one.
    const History fresh = along.initial_history();
    const std::vector<double> u = stretched(body.points, 5, 0.3);
    expect_equal(sums_of(along, {u, fresh}, u.size()), sums_of(single, {u, fresh}, u.size()));
    expect_equal(sums_of(along, {u, one}, u.size()), sums_of(single, {u, other}, u.size()));
  }
}

TEST_P(BondRunsIn, ProductsMayBeInSinglePrecision) {
  const BoxBody body = cut_body(rows_of(GetParam(), softening));
  const Model list = one_by_one(body.model);
  Assembler along(body.points, body.model, 2), single(body.points, list, 2);
  EXPECT_TRUE(along.has_single_products());
  EXPECT_FALSE(single.has_single_products());
  const std::vector<double> u = stretched(body.points, 5, 0.01);
  const History history = along.initial_history();
  const Sums sums = sums_of(along, {u, history}, u.size());
  EXPECT_GT(difference(sums.in_single, sums.product), 1e-9);
  // Rigid motions cost nothing: differences are in double precision, at whatever distance.
  const std::vector<double> ones(u.size(), 1e6);
  std::vector<double> product(u.size());
  StateView roughly{u, history};
  roughly.precision = Precision::single;
  along.product(roughly, ones, product);
  EXPECT_EQ(tests::largest(product), 0.0);
}

/// Neither small cells and large moduli nor small vectors leave the range of single precision.
TEST_P(BondRunsIn, ProductsInSinglePrecisionMayHaveAnyUnit) {
  for (const double spacing : {1e-9, 1e-6, 1e3}) {
    BoxSetting box = rows_of(GetParam(), whole);
    box.spacing = spacing;
    box.youngs_modulus = 2e11;
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    const std::vector<double> u = stretched(body.points, 5, 0.01);
    StateView roughly{u};
    roughly.precision = Precision::single;
    for (const double size : {1.0, 1e-12}) {
      const std::vector<double> v = Random(3).vector(u.size(), size);
      std::vector<double> product(u.size()), in_single(u.size());
      assembler.product(StateView{u}, v, product);
      assembler.product(roughly, v, in_single);
      EXPECT_LT(difference(in_single, product), 1e-6) << spacing << ' ' << size;
      EXPECT_GT(difference(in_single, product), 1e-9) << spacing << ' ' << size;
    }
  }
}

/// As in mode path, and where release breaks a bond.
TEST_P(BondRunsIn, BondsMayBeBrokenAtTheirOnset) {
  const BoxBody body = cut_body(rows_of(GetParam(), brittle));
  const Model list = one_by_one(body.model);
  Assembler along(body.points, body.model, 2), single(body.points, list, 2);
  std::vector<double> largest(std::size_t(body.model.bonds().count()), 0.0);
  for (std::size_t bond = 0; bond < largest.size(); bond += 7) largest[bond] = critical;
  const History history = along.history_of(largest);
  const std::vector<double> u = stretched(body.points, 5, 0.1);
  const Sums found = sums_of(along, {u, history}, u.size());
  expect_equal(found, sums_of(single, {u, history}, u.size()));
  EXPECT_LT(found.energy, 0.95 * along.energy({u, along.initial_history()}).energy);
}

TEST_P(BondRunsIn, EigenstretchesAreThoseOfSingleBonds) {
  const BoxBody body = cut_body(rows_of(GetParam(), softening));
  const Model list = one_by_one(body.model);
  Assembler along(body.points, body.model, 2), single(body.points, list, 2);
  const auto heated = std::make_shared<Environment>();
  heated->eigenstretch = Random(13).vector(body.points.volume.size(), 0.1);
  const std::vector<double> u = stretched(body.points, 5, 0.1);
  const History history = along.initial_history();
  const StateView at{u, history, Damage::grows, heated};
  expect_equal(sums_of(along, at, u.size()), sums_of(single, at, u.size()));
}

TEST_P(BondRunsIn, LawsThatDifferFromBondToBond) {
  const BoxSetting box = rows_of(GetParam(), whole);
  const BoxBody elastic(box);
  const auto laws =
      std::make_shared<BondLaws>(std::vector<AnyBondLaw>{AnyBondLaw(CriticalStretch{critical})},
                                 std::size_t(elastic.model.bonds().count()));
  Random random(17);
  for (Offset bond = 0; bond < laws->bonds(); ++bond) {
    const double strength = critical * (1.0 + 0.5 * random.number());
    laws->set(bond, 0, strength, strength);
  }
  BoxSetting differing = box;
  differing.potential = [&](double modulus) -> BondPotential {
    return DegradedByBond<>{modulus, laws};
  };
  const BoxBody body(differing);
  const Model list = one_by_one(body.model);
  Assembler along(body.points, body.model, 2), single(body.points, list, 2);
  History one = along.initial_history(), other = one;
  for (const double most : {0.05, 0.3, 0.1}) {
    const std::vector<double> u = stretched(body.points, 5, most);
    std::vector<double> forces(u.size()), forces_of_single(u.size());
    const Evaluation committed = along.commit(u, one, forces),
                     expected = single.commit(u, other, forces_of_single);
    EXPECT_EQ(committed.growth.breaking, expected.growth.breaking);
    EXPECT_LT(difference(forces, forces_of_single), 1e-12);
    expect_equal(sums_of(along, {u, one}, u.size()), sums_of(single, {u, other}, u.size()));
  }
  EXPECT_GT(tests::largest(body.model.failure_history(one)), critical / 2);
}

TEST_P(BondRunsIn, PointsThatCoincideAreDegenerate) {
  const BoxBody body(rows_of(GetParam(), whole));
  Assembler along(body.points, body.model, 1);
  std::vector<double> u(body.dofs(), 0.0), forces(u.size());
  const Index middle = body.points.count() / 2 + 1;
  EXPECT_FALSE(along.gradient(StateView{u}, forces).degenerate);
  const int dimension = GetParam().dimension;
  for (int c = 0; c < dimension; ++c) {
    const auto at = [&](Index i) { return std::size_t(i * dimension + c); };
    u[at(middle)] = body.points.reference[at(middle + 1)] - body.points.reference[at(middle)];
  }
  EXPECT_TRUE(along.gradient(StateView{u}, forces).degenerate);
}

/// The bonds of a group in runs and loose ones are those of its points, each once.
void expect_covered(const BoxBody& body, const BondRuns& runs) {
  const Bonds& bonds = body.model.bonds();
  std::vector<int> found(std::size_t(bonds.count()), 0);
  for (std::size_t g = 0; g < runs.groups(); ++g) {
    const BondRuns::Group group = runs.group(g);
    for (const BondRun& run : group.runs) {
      EXPECT_GE(run.points, BondRuns::shortest);
      EXPECT_LE(run.points, BondRuns::longest);
      for (Index i = run.first; i < run.last(); ++i) {
        const Offset bond = *bonds.find(i, i + run.ahead);
        if (run.kinds) {
          EXPECT_GE(run.points, BondRuns::shortest_of_several);
          EXPECT_EQ(bonds.kind.number(bond), run.kinds[i - run.first]);
        } else {
          EXPECT_EQ(bonds.kind[bond], bonds.kind[run.first_bond(bonds)]);
        }
        ++found[std::size_t(bond)];
      }
    }
    for (const LooseBonds& loose : group.loose) {
      EXPECT_GE(loose.first, bonds.offset[loose.point]);
      EXPECT_LE(loose.last, bonds.offset[loose.point + 1]);
      for (Offset bond = loose.first; bond < loose.last; ++bond) ++found[std::size_t(bond)];
    }
  }
  for (const int times : found) ASSERT_EQ(times, 1);
}

TEST(BondRuns, CoverEveryBondOnce) {
  for (const int dimension : {1, 2, 3}) {
    const BoxBody body = cut_body(rows_of({dimension, 0.0}, whole));
    expect_covered(body, BondRuns(body.points, body.model.bonds(), body.model.bonds().kind, 0,
                                  body.points.count()));
  }
}

TEST(BondRuns, HoldAllBondsOfALattice) {
  BoxSetting box = tests::small_box(2);
  box.extent = {30, 20, 0};
  const BoxBody body(box);
  EXPECT_EQ(share_in_runs(body.points, body.model.bonds(), 3), 1.0);
  const BondRuns runs(body.points, body.model.bonds(), body.model.bonds().kind, 0,
                      body.points.count());
  EXPECT_EQ(runs.groups(), 30u);  // rows along the shorter side
}

TEST(BondRuns, MayHaveBondsOfSeveralKinds) {
  BoxSetting box = tests::small_box(2);
  box.extent = {30, 20, 0};
  box.perturbation = 1e-9;
  const BoxBody perturbed(box);
  ASSERT_TRUE(perturbed.model.bonds().kind.are_numbered());
  EXPECT_EQ(share_in_runs(perturbed.points, perturbed.model.bonds(), 1), 1.0);
  const BondRuns runs(perturbed.points, perturbed.model.bonds(), perturbed.model.bonds().kind, 0,
                      perturbed.points.count());
  expect_covered(perturbed, runs);
  EXPECT_TRUE(std::ranges::all_of(runs.runs(), [](const BondRun& run) { return run.kinds; }));
}

TEST(BondRuns, EndWhereKindsChangeThatHaveNoNumbers) {
  BoxSetting box = tests::small_box(2);
  box.extent = {150, 100, 0};
  box.perturbation = 1e-3;
  const BoxBody perturbed(box);
  ASSERT_FALSE(perturbed.model.bonds().kind.are_numbered());
  EXPECT_EQ(share_in_runs(perturbed.points, perturbed.model.bonds(), 1), 0.0);
}

TEST(BondRuns, HaveNoGhosts) {
  BoxSetting box = tests::small_box(2);
  box.extent = {30, 20, 0};
  BoxBody owned(box);
  owned.points.owned = 10 * 20;
  const BondRuns runs(owned.points, owned.model.bonds(), owned.model.bonds().kind, 0,
                      owned.points.count());
  expect_covered(owned, runs);
  for (const BondRun& run : runs.runs()) EXPECT_LE(run.last() + run.ahead, 10 * 20);
}

}  // namespace
}  // namespace peristat
