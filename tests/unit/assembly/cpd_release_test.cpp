// Damage of bonds with triangles and tetrahedra by what they set free: exact drops of energy,
// tears, stability of what is left, and the bond model's limit.
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "src/materials/cpd_constants.hpp"
#include "src/potentials/potential.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::BoxSetting;
using tests::distance;
using tests::norm;
using tests::Random;

constexpr double critical = 0.02;

std::function<BondPotential(double)> brittle(double stretch = critical) {
  return [=](double modulus) { return Degraded<CriticalStretch>{modulus, {stretch}}; };
}
std::function<BondPotential(double)> softening() {
  return [](double modulus) {
    return Degraded<ForceEnvelope>{modulus, {0.5 * critical, critical}};
  };
}

/// A box whose triangles and tetrahedra have constants of either sign.
BoxSetting release_box(int dimension, double triangles, double tetrahedra = 0.0) {
  BoxSetting box = tests::small_box(dimension);
  box.triangles = triangles;
  box.tetrahedra = tetrahedra;
  box.drive = DamageDrive::release;
  box.potential = brittle();
  return box;
}

/// A square lattice whose constants are those of Poisson's ratio, E = 3 Pa.
/// @param c2 of a body in 3D, in units of E horizon^-8
BoxSetting lattice_of(double poisson_ratio, int dimension, std::array<int, 3> extent,
                      double horizon_ratio, double c2 = 0.0) {
  BoxSetting box = release_box(dimension, 0.0);
  box.extent = extent;
  box.horizon_ratio = horizon_ratio;
  const CpdConstants constants =
      lattice_stiffness(dimension, box.spacing, horizon_ratio * box.spacing, box.cross_section)
          .constants(lame_moduli(box.youngs_modulus, poisson_ratio, dimension),
                     c2 * box.youngs_modulus / std::pow(horizon_ratio * box.spacing, 8));
  // As BoxBody scales them, with the C1 of the lattice.
  const double volume =
      bulk_neighbourhood(dimension, box.spacing, horizon_ratio * box.spacing, box.cross_section)
          .volume;
  const double unit = horizon_ratio * box.spacing * volume;
  box.triangles = constants.c2 / constants.c1 * unit;
  box.tetrahedra = constants.c3 / constants.c1 * unit * unit;
  return box;
}

/// Weights of the bonds of BoxBody do not matter here, but those of a lattice's constants do.
BoxBody body_of(const BoxSetting& box) {
  BoxBody body(box);
  Bonds bonds = body.model.bonds();
  set_one_neighbour_weights(
      bonds, body.points,
      bulk_neighbourhood(box.dimension, box.spacing, body.setting.horizon, box.cross_section));
  body.replace_bonds(std::move(bonds));
  return body;
}

double dissipated(Assembler& assembler, const History& history) {
  std::vector<double> damage(std::size_t(assembler.points().count()));
  return assembler.assess(history, {}, damage).dissipated_energy;
}

/// Moves the points beyond a height apart, with a slip along the plane.
std::vector<double> torn(const BoxBody& body, double height, double opening, double slip = 0.0) {
  const auto d = std::size_t(body.points.dimension);
  std::vector<double> u(body.dofs(), 0.0);
  for (Index i = 0; i < body.points.count(); ++i) {
    if (body.points.position(i)[0] < height) continue;
    u[std::size_t(i) * d] = opening;
    u[std::size_t(i) * d + 1] = slip * opening;
  }
  return u;
}

/// sum over the bonds across a height of w L C1 times the work of the law.
double taken_across(const BoxBody& body, double height) {
  const auto* failure = body.model.failing_bonds();
  double sum = 0.0;
  const std::vector<double> history = failure->initial_history();
  failure->with_damage_law(history, [&](const auto& law) {
    tests::for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset bond) {
      if ((body.points.position(i)[0] < height) == (body.points.position(j)[0] < height)) return;
      sum += body.model.bonds().weight(bond) * body.model.bonds().length(bond) *
             law.of_bond(bond).dissipated(1.0);
    });
  });
  return sum;
}

/// Bodies in 2D and 3D with constants of every sign.
std::vector<BoxSetting> release_boxes() {
  std::vector<BoxSetting> all;
  for (const double sign : {-0.3, 0.5}) {
    all.push_back(release_box(2, sign));
    all.push_back(release_box(3, sign, 0.5));
    all.push_back(release_box(3, 0.5, sign));
    all.push_back(release_box(3, 0.0, sign));
  }
  for (std::size_t k = 0; k < all.size(); k += 2) all[k].stored = true;
  for (BoxSetting& box : all) box.perturbation = 0.15;
  return all;
}

/// Y is the derivative of the energy by the integrity of a bond, in which the energy is linear,
/// also beside bonds that have softened.
TEST(CpdRelease, EquivalentStretchesAreDerivativesOfTheEnergy) {
  for (BoxSetting box : release_boxes()) {
    box.potential = softening();
    const BoxBody body(box, 2);
    Assembler assembler(body.points, body.model, 2);
    const Bonds& bonds = body.model.bonds();
    const std::vector<double> u = Random(6).vector(body.dofs(), 0.02 * box.spacing);
    Random random(8);
    std::vector<double> before(std::size_t(bonds.count()), 0.0);
    for (double& stretch : before) {
      if (random.number() > 0.6) stretch = 0.5 * critical * (1.5 + 0.4 * random.number());
    }
    const double modulus = std::get<Degraded<ForceEnvelope>>(body.potential()).modulus;
    const auto energy = [&](Offset bond, double stretch) {
      std::vector<double> stretches = before;
      stretches[std::size_t(bond)] = stretch;
      return assembler.energy({u, assembler.history_of(stretches)}).energy;
    };
    double largest = 0.0;
    tests::for_each_bond(bonds, [&](Index i, Index j, Offset bond) {
      double rest = 0.0, now = 0.0;
      for (std::size_t c = 0; c < std::size_t(box.dimension); ++c) {
        const std::size_t from = std::size_t(i * box.dimension) + c;
        const std::size_t to = std::size_t(j * box.dimension) + c;
        const double arm = body.points.reference[to] - body.points.reference[from];
        rest += arm * arm;
        now += std::pow(arm + u[to] - u[from], 2);
      }
      if (now <= rest) return;
      const double release = energy(bond, 0.0) - energy(bond, critical);
      const double squared = 2.0 * release / (bonds.weight(bond) * bonds.length(bond) * modulus);
      const double borne = std::max(0.5 * critical, before[std::size_t(bond)]);
      largest = std::max(largest, std::sqrt(std::max(squared, 0.0)) / borne);
    });
    const History history = assembler.history_of(before);
    EXPECT_NEAR(assembler.growth({u, history}).utilisation, largest, 1e-7 * largest);
    EXPECT_GT(largest, 1.0);
  }
}

/// A commit dissipates what bonds take, never more than the energy falls; nothing is left to
/// damage.
TEST(CpdRelease, NoCommitSetsLessFreeThanItTakes) {
  for (BoxSetting box : release_boxes()) {
    for (const auto& law : {brittle(), softening()}) {
      box.potential = law;
      const BoxBody body(box, 2);
      Assembler assembler(body.points, body.model, 2);
      History history = assembler.initial_history();
      double taken = 0.0;
      int damaging = 0;
      for (const double size : {0.02, 0.05, 0.03, 0.1}) {
        const std::vector<double> u = Random(9).vector(body.dofs(), size * box.spacing);
        const double before = assembler.energy({u, history}).energy;
        const DamageGrowth growth = assembler.growth({u, history});
        const Evaluation after = assembler.commit(u, history, {});
        const double now = dissipated(assembler, history);
        EXPECT_EQ(after.released, 0.0);
        EXPECT_EQ(after.moves_equilibrium, growth.degrading > 0);
        EXPECT_GE(before - after.energy, now - taken - 1e-13 * std::abs(before));
        EXPECT_EQ(after.energy, assembler.energy({u, history}).energy);
        EXPECT_EQ(assembler.growth({u, history}).degrading, 0);
        EXPECT_EQ(assembler.commit(u, history, {}).growth.degrading, 0);
        // The integrities of triangles are those of the bonds.
        const std::span<const double> known = bond_stretches(body.model, history);
        const History same = assembler.history_of(known);
        EXPECT_EQ(assembler.energy({u, same}).energy, after.energy);
        damaging += after.growth.degrading > 0;
        taken = now;
      }
      EXPECT_GE(damaging, 2);
    }
  }
}

/// In a search bonds keep the integrity of their history: energy, forces and tangent are those of
/// one elastic body.
TEST(CpdRelease, BondsDoNotSoftenInASearch) {
  BoxSetting box = release_box(2, 0.5);
  box.potential = softening();
  const BoxBody body(box);
  Assembler assembler(body.points, body.model, 1);
  const History history = assembler.initial_history();
  const std::vector<double> u = Random(3).vector(body.dofs(), 0.05 * box.spacing);
  ASSERT_GT(assembler.growth({u, history}).breaking, 0);
  BoxSetting elastic = box;
  elastic.potential = {};
  const BoxBody whole(elastic);
  Assembler of_whole(whole.points, whole.model, 1);
  std::vector<double> one(body.dofs()), other(body.dofs());
  const double energy = assembler.gradient({u, history}, one).energy;
  EXPECT_NEAR(energy, of_whole.gradient(u, other).energy, 1e-14 * energy);
  EXPECT_LT(distance(one, other), 1e-14 * norm(other));
}

/// Without energy of triangles: the bond model, bit for bit but for the rounding of roots of
/// squares over products.
TEST(CpdRelease, IsTheBondModelWithoutTriangles) {
  for (const int d : {2, 3}) {
    BoxSetting box = release_box(d, 1.0, d == 3 ? 1.0 : 0.0);
    box.perturbation = 0.1;
    BoxBody body(box);
    auto triangles = body.simplices<Area>(1.0, box, 1);
    triangles->potential = Harmonic{0.0};
    Model idle(body.model.bonds(), body.potential(), {}, DamageDrive::release);
    idle.add(std::make_shared<SimplexTerm>(idle.bond_failure(), triangles, std::nullopt));
    const Model alone = body.bonds_alone();
    Assembler by_release(body.points, idle, 1), by_stretch(body.points, alone, 1);
    History of_release = by_release.initial_history(), of_stretch = by_stretch.initial_history();
    std::vector<double> one(body.dofs()), other(body.dofs());
    Index broken = 0;
    for (int step = 1; step <= 20; ++step) {
      std::vector<double> u = torn(body, 0.25, 0.003 * box.spacing * step, 0.3);
      const std::vector<double> disorder = Random(7).vector(body.dofs(), 2e-4);
      for (std::size_t k = 0; k < u.size(); ++k) u[k] += disorder[k];
      const Evaluation a = by_release.commit(u, of_release, one);
      const Evaluation b = by_stretch.commit(u, of_stretch, other);
      EXPECT_EQ(a.growth.breaking, b.growth.breaking);
      EXPECT_NEAR(a.energy, b.energy, 1e-14 * b.energy);
      EXPECT_LT(distance(one, other), 1e-14 * norm(other));
      const auto left = bond_stretches(idle, of_release), right = bond_stretches(alone, of_stretch);
      for (std::size_t k = 0; k < left.size(); ++k) {
        EXPECT_NEAR(left[k], right[k], 1e-15) << k;
      }
      broken += a.growth.breaking;
    }
    EXPECT_GT(broken, 20);
  }
}

class TearOfPoisson : public ::testing::TestWithParam<std::tuple<int, double>> {};
INSTANTIATE_TEST_SUITE_P(Ratios, TearOfPoisson,
                         ::testing::Combine(::testing::Values(2, 3),
                                            ::testing::Values(0.0, 0.2, 0.334, 0.45)));

/// Whatever nu is, a tear takes what its bonds take, and the energy never falls by less.
TEST_P(TearOfPoisson, TakesWhatItsBondsTake) {
  const auto [d, nu] = GetParam();
  for (const auto& law : {brittle(), softening()}) {
    for (const double slip : {0.0, 0.7}) {
      BoxSetting box =
          d == 2 ? lattice_of(nu, 2, {12, 9, 0}, 3.015) : lattice_of(nu, 3, {6, 4, 4}, 2.015);
      box.potential = law;
      const BoxBody body = body_of(box);
      Assembler assembler(body.points, body.model, 1);
      const double height = 0.5 * box.extent[0] * box.spacing;
      const double expected = taken_across(body, height);
      History history = assembler.initial_history();
      double taken = 0.0, drained = 0.0;
      // Far enough to stretch bonds along the plane, too, whichever way they slip.
      const double last = 8.0 * box.spacing;
      for (int step = 1; step <= 120; ++step) {
        const std::vector<double> u = torn(body, height, last * std::pow(1.08, step - 120), slip);
        const double before = assembler.energy({u, history}).energy;
        const Evaluation after = assembler.commit(u, history, {});
        const double now = dissipated(assembler, history);
        EXPECT_GE(before - after.energy, now - taken - 1e-13 * expected);
        drained += before - after.energy - (now - taken);
        taken = now;
      }
      EXPECT_NEAR(taken, expected, 1e-12 * expected) << slip;
      EXPECT_GT(drained, 0.0);
    }
  }
}

/// What is drained is the step of the opening, but for what triangles of negative energy hold back.
TEST(CpdRelease, SmallerStepsDrainLess) {
  for (const double nu : {1.0 / 3.0 + 1e-6, 0.45}) {
    std::vector<double> excess;
    for (const int steps : {50, 200, 800}) {
      BoxSetting box = lattice_of(nu, 2, {12, 9, 0}, 3.015);
      box.potential = softening();
      const BoxBody body = body_of(box);
      Assembler assembler(body.points, body.model, 1);
      const double height = 0.5 * box.extent[0] * box.spacing;
      History history = assembler.initial_history();
      double dropped = 0.0;
      for (int step = 1; step <= steps; ++step) {
        const std::vector<double> u =
            torn(body, height, 1.1 * critical * box.spacing * box.horizon_ratio * step / steps);
        const double before = assembler.energy({u, history}).energy;
        dropped += before - assembler.commit(u, history, {}).energy;
      }
      excess.push_back(dropped / dissipated(assembler, history) - 1.0);
    }
    EXPECT_LT(excess[0], 0.3) << nu;
    EXPECT_NEAR(excess[0] / excess[1], 4.0, 1.0) << nu;
    EXPECT_NEAR(excess[1] / excess[2], 4.0, 1.0) << nu;
  }
}

/// Triangles of negative energy hold bonds back, and the rest is drained as these go: more of it
/// the farther nu is below 1/3.
TEST(CpdRelease, NegativeConstantsDrainMore) {
  for (const auto& [nu, drained] : {std::pair(0.2, 0.016), std::pair(0.0, 0.067)}) {
    BoxBody body = body_of(lattice_of(nu, 2, {12, 30, 0}, 3.015));
    // A tear that does not begin at the ends, where bonds have fewer triangles.
    std::vector<char> never_fails;
    tests::for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset) {
      const auto is_end = [&](Index point) {
        return std::abs(body.points.position(point)[1] / body.points.spacing - 15.0) > 12.0;
      };
      never_fails.push_back(is_end(i) || is_end(j));
    });
    body.replace_bonds(body.model.bonds(), never_fails);
    Assembler assembler(body.points, body.model, 1);
    const double height = 0.5 * 12 * body.points.spacing;
    History history = assembler.initial_history();
    double dropped = 0.0;
    const int steps = 400;
    for (int step = 1; step <= steps; ++step) {
      const std::vector<double> u = torn(body, height, 0.2 * body.points.spacing * step / steps);
      const double before = assembler.energy({u, history}).energy;
      dropped += before - assembler.commit(u, history, {}).energy;
    }
    // The steps of the opening add half a per cent.
    EXPECT_NEAR(dropped / dissipated(assembler, history) - 1.0, drained, 0.01) << nu;
  }
}

/// Smallest over largest eigenvalue of a lattice at rest that is held along two faces.
double least_eigenvalue(const BoxBody& body, const std::vector<double>& stretches) {
  Assembler assembler(body.points, body.model, 2);
  const History history = assembler.history_of(stretches);
  const std::vector<double> u(body.dofs(), 0.0);
  const auto d = std::size_t(body.points.dimension);
  std::vector<std::size_t> free;
  double far = 0.0;
  for (Index i = 0; i < body.points.count(); ++i) far = std::max(far, body.points.position(i)[0]);
  for (std::size_t k = 0; k < body.dofs(); ++k) {
    const double x = body.points.position(Index(k / d))[0];
    if (x > body.points.spacing && x < far - 0.5 * body.points.spacing) free.push_back(k);
  }
  Eigen::MatrixXd stiffness(free.size(), free.size());
  std::vector<double> v(body.dofs(), 0.0), product(body.dofs());
  for (std::size_t column = 0; column < free.size(); ++column) {
    v[free[column]] = 1.0;
    assembler.product({u, history}, v, product);
    v[free[column]] = 0.0;
    for (std::size_t row = 0; row < free.size(); ++row) {
      stiffness(Eigen::Index(row), Eigen::Index(column)) = product[free[row]];
    }
  }
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness, Eigen::EigenvaluesOnly)
          .eigenvalues();
  return values.minCoeff() / values.maxCoeff();
}

void expect_stable(BoxSetting box);

/// Triangles go with their bonds, so that what is left of a stable body is stable.
TEST_P(TearOfPoisson, LeavesAStableBody) {
  const auto [d, nu] = GetParam();
  expect_stable(d == 2 ? lattice_of(nu, 2, {9, 12, 0}, 3.015)
                       : lattice_of(nu, 3, {5, 4, 4}, 2.015));
}
TEST(CpdRelease, LeavesAStableBodyOfNegativeTriangles) {
  expect_stable(lattice_of(0.1, 3, {5, 4, 4}, 2.015, -0.1));
  expect_stable(lattice_of(0.0, 3, {5, 4, 4}, 2.5, -0.05));
}

void expect_stable(BoxSetting box) {
  box.potential = softening();
  const BoxBody body = body_of(box);
  const auto bonds = std::size_t(body.model.bonds().count());
  const double whole = least_eigenvalue(body, std::vector<double>(bonds, 0.0));
  EXPECT_GT(whole, 0.01);
  for (const double share : {0.1, 0.3, 0.5}) {
    for (int seed = 1; seed <= 3; ++seed) {
      Random random(std::uint64_t(seed) * 100);
      std::vector<double> stretches(bonds, 0.0), partial(bonds, 0.0);
      for (std::size_t k = 0; k < bonds; ++k) {
        if (0.5 * (random.number() + 1.0) < share) stretches[k] = critical;
        if (0.5 * (random.number() + 1.0) < 0.7)
          partial[k] = critical * (0.75 + 0.25 * random.number());
      }
      // Points of a small lattice may hang on few bonds, but none is unstable.
      EXPECT_GT(least_eigenvalue(body, stretches), -1e-12) << share;
      EXPECT_GT(least_eigenvalue(body, partial), 0.1 * whole);
    }
  }
}

/// Without triangles nothing but its stretch drives a bond: it fails as by stretch.
TEST(CpdRelease, OfBondsAloneIsThatOfTheirStretches) {
  BoxSetting by_stretch = release_box(2, 0.0);
  by_stretch.drive = DamageDrive::stretch;
  const BoxBody one(release_box(2, 0.0)), other(by_stretch);
  Assembler release(one.points, one.model, 2), stretch(other.points, other.model, 2);
  const std::vector<double> u = Random(7).vector(one.dofs(), 0.01);
  History of_release = release.initial_history(), of_stretch = stretch.initial_history();
  const DamageGrowth growth = release.growth({u, of_release});
  EXPECT_GT(growth.breaking, 10);
  EXPECT_EQ(growth.breaking, stretch.growth({u, of_stretch}).breaking);
  EXPECT_NEAR(growth.utilisation, stretch.growth({u, of_stretch}).utilisation,
              1e-13 * growth.utilisation);
  EXPECT_EQ(release.commit(u, of_release, {}).growth.breaking, growth.breaking);
  EXPECT_EQ(stretch.commit(u, of_stretch, {}).growth.breaking, growth.breaking);
  EXPECT_EQ(broken_bonds(one.model, of_release), broken_bonds(other.model, of_stretch));
}

}  // namespace
}  // namespace peristat
