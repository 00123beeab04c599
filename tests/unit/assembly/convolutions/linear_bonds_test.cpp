#include "assembly/convolutions/linear_bonds.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/operators/tangent.hpp"
#include "src/geometry/lattice.hpp"
#include "tests/bodies.hpp"
#include "tests/lattice_systems.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::BoxSetting;

using tests::HoledBody;
using tests::open;

/// A lattice's body with holes, and the operator of its bonds.
struct System {
  BoxBody body;
  LatticeBox box;
  std::vector<LatticeSpring> springs;
  LinearBonds bonds;

  System(const Points& points, const BoxSetting& setting, int threads = 1)
      : body(points, setting),
        box(box_of(points)),
        springs(springs_of(body)),
        bonds(box, open, springs, threads) {}

  static LatticeBox box_of(const Points& points) {
    std::string why_not;
    return lattice_box(points, why_not).value();
  }
  static std::vector<LatticeSpring> springs_of(const BoxBody& body) {
    const double modulus =
        std::visit([](const auto& law) { return law.modulus; }, body.potential());
    return lattice_springs(body.setting, body.points.spacing, body.points.angle, modulus,
                           body.points.volume.front());
  }
  std::vector<double> random(std::uint64_t seed) const {
    return tests::Random(seed).vector(body.dofs());
  }
};

/// Bodies of each dimension with something cut out, whole and with a mask.
Points points_of(int dimension, double angle = 0.0, const Spacing& spacing = 0.1) {
  Lattice lattice;
  lattice.dimension = dimension;
  lattice.spacing = spacing;
  lattice.angle = angle;
  lattice.cross_section = dimension == 3 ? 1.0 : 0.5;
  const Coordinates extent = dimension == 1   ? Coordinates{2.0, 0.0, 0.0}
                             : dimension == 2 ? Coordinates{1.3, 1.0, 0.0}
                                              : Coordinates{0.7, 0.6, 0.9};
  lattice.shapes.push_back({ShapeStep::Action::add, Box{{}, extent}});
  if (dimension == 2) {
    lattice.shapes.push_back({ShapeStep::Action::subtract, Disk{{0.5, 0.5}, 0.16}});
  }
  if (dimension == 3) {
    lattice.shapes.push_back({ShapeStep::Action::subtract, Sphere{{0.3, 0.3, 0.3}, 0.16}});
  }
  return make_points(lattice);
}

BoxSetting setting_of(int dimension, double ratio, VolumeCorrection volume) {
  BoxSetting setting;
  setting.dimension = dimension;
  setting.horizon_ratio = ratio;
  setting.cross_section = dimension == 3 ? 1.0 : 0.5;
  setting.quadrature.volume = volume;
  return setting;
}

struct Sums {
  std::vector<double> force, energy;
};

/// The same bond by bond, from the bonds of the body.
Sums direct_sums(const BoxBody& body, const std::vector<double>& q, const std::vector<double>& u) {
  const Bonds& bonds = body.model.bonds();
  const int d = body.points.dimension;
  const double modulus = std::visit([](const auto& law) { return law.modulus; }, body.potential());
  Sums sums{std::vector<double>(u.size(), 0.0), std::vector<double>(q.size(), 0.0)};
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner(i, bond);
      const Coordinates a = body.points.position(i), b = body.points.position(j);
      const double length = bonds.length(bond);
      const double k = q[i] * q[j] * modulus * bonds.weight(bond) / length;
      double along = 0.0;
      for (int c = 0; c < d; ++c) along += (b[c] - a[c]) / length * (u[j * d + c] - u[i * d + c]);
      for (int c = 0; c < d; ++c) {
        const double force = k * along * (b[c] - a[c]) / length;
        sums.force[i * d + c] += force;
        sums.force[j * d + c] -= force;
      }
      sums.energy[i] += 0.25 * k * along * along;
      sums.energy[j] += 0.25 * k * along * along;
    }
  }
  return sums;
}

void expect_direct_sums(System& system, const std::vector<double>& q) {
  const std::vector<double> u = system.random(5);
  const Sums expected = direct_sums(system.body, q, u);
  ASSERT_GT(tests::norm(expected.force), 0.0);
  ASSERT_GT(tests::norm(expected.energy), 0.0);
  system.bonds.set_integrity(q);
  std::vector<double> force(u.size(), 7.0), energy(q.size(), 7.0);
  system.bonds.find_forces_and_energies(u, force, energy);
  EXPECT_LE(tests::distance(force, expected.force), 1e-13 * tests::norm(expected.force));
  EXPECT_LE(tests::distance(energy, expected.energy), 1e-13 * tests::norm(expected.energy));
  std::vector<double> again(u.size());
  system.bonds.find_forces(u, again);
  EXPECT_EQ(again, force);
}

TEST(LinearBonds, AreTheDirectSumsOverBonds) {
  for (const int dimension : {1, 2, 3}) {
    for (const double ratio : {2.015, 3.015}) {
      for (const VolumeCorrection volume : {VolumeCorrection::none, VolumeCorrection::linear}) {
        SCOPED_TRACE(std::to_string(dimension) + "D, ratio " + std::to_string(ratio));
        System system(points_of(dimension), setting_of(dimension, ratio, volume), 2);
        const std::size_t points = std::size_t(system.body.points.count());
        ASSERT_EQ(points<system.box.count(), dimension> 1);  // there is a hole
        std::vector<double> q(points, 1.0);
        expect_direct_sums(system, q);
        // Points that are gone, and points that are damaged in part.
        for (std::size_t i = 0; i < points; i += 5) q[i] = 0.0;
        for (std::size_t i = 2; i < points; i += 7) q[i] = 0.3;
        expect_direct_sums(system, q);
      }
    }
  }
}

TEST(LinearBonds, AreThoseOfTurnedAndOblongLattices) {
  BoxSetting setting = setting_of(2, 3.015, VolumeCorrection::none);
  System turned(points_of(2, 27.0), setting);
  ASSERT_NE(turned.body.points.angle, 0.0);
  expect_direct_sums(turned, std::vector<double>(std::size_t(turned.body.points.count()), 1.0));
  System oblong(points_of(2, 0.0, Spacing({0.1, 0.08}, 2)), setting);
  expect_direct_sums(oblong, std::vector<double>(std::size_t(oblong.body.points.count()), 1.0));
}

TEST(LinearBonds, MultiplyLikeTheTangentAtRest) {
  // By the assembler, which knows harmonic bonds of any deformation.
  for (const int dimension : {1, 2, 3}) {
    System system(points_of(dimension), setting_of(dimension, 3.015, VolumeCorrection::linear));
    Tangent tangent(BlockPattern(system.body.model.bonds()), dimension);
    Assembler(system.body.points, system.body.model, 1)
        .tangent(std::vector<double>(system.body.dofs(), 0.0), tangent);
    const std::vector<double> v = system.random(2);
    std::vector<double> expected(v.size()), product(v.size());
    tangent.multiply(v, expected);
    system.bonds.multiply(v, v, product);
    EXPECT_LE(tests::distance(product, expected), 1e-13 * tests::norm(expected));
    std::vector<double> diagonal(tangent.diagonal.size()), bounds(v.size()), sums(v.size());
    system.bonds.outline_tangent(v, diagonal, bounds);
    tangent.absolute_row_sums(sums);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      EXPECT_GE(bounds[k], (1.0 - 1e-12) * sums[k]);
      EXPECT_LE(bounds[k], 1.5 * sums[k] + 1e-12 * tests::norm(sums));
    }
    EXPECT_LE(tests::distance(diagonal, tangent.diagonal), 1e-13 * tests::norm(tangent.diagonal));
  }
}

TEST(LinearBonds, ForcesAreMinusTheDerivativeOfTheEnergy) {
  for (const int dimension : {2, 3}) {
    System system(points_of(dimension), setting_of(dimension, 2.015, VolumeCorrection::none));
    const std::size_t points = std::size_t(system.body.points.count());
    std::vector<double> q = tests::Random(4).vector(points);
    for (double& entry : q) entry = std::abs(entry);
    system.bonds.set_integrity(q);
    const std::vector<double> u = system.random(5), v = system.random(6);
    const auto energy_at = [&](double step) {
      std::vector<double> at(u), force(u.size()), energy(points);
      for (std::size_t k = 0; k < at.size(); ++k) at[k] += step * v[k];
      system.bonds.find_forces_and_energies(at, force, energy);
      double sum = 0.0;
      for (const double of_point : energy) sum += of_point;
      return sum;
    };
    std::vector<double> force(u.size());
    system.bonds.find_forces(u, force);
    // Central differences of a quadratic are exact.
    const double derivative = 0.5 * (energy_at(1.0) - energy_at(-1.0));
    ASSERT_GT(std::abs(derivative), 1e-3 * energy_at(0.0));
    EXPECT_NEAR(derivative, -tests::dot(force, v), 1e-12 * energy_at(1.0));
    // Without an energy beside it: -u.f/2.
    EXPECT_NEAR(energy_at(0.0), -0.5 * tests::dot(force, u), 1e-12 * energy_at(0.0));
  }
}

TEST(LinearBonds, FarTranslationsCostNoDigits) {
  System system(points_of(2), setting_of(2, 3.015, VolumeCorrection::none));
  std::vector<double> u = system.random(5);
  for (double& entry : u) entry *= 1e-4;
  const std::size_t points = std::size_t(system.body.points.count());
  std::vector<double> force(u.size()), energy(points), far_force(u.size()), far_energy(points);
  system.bonds.find_forces_and_energies(u, force, energy);
  for (double& entry : u) entry += 0.1;
  system.bonds.find_forces_and_energies(u, far_force, far_energy);
  // What 0.1 m leaves of the digits of u itself: 1e-17 of 1e-4.
  EXPECT_LE(tests::distance(far_energy, energy), 1e-11 * tests::norm(energy));
  EXPECT_LE(tests::distance(far_force, force), 1e-11 * tests::norm(force));
  ASSERT_GT(tests::norm(energy), 0.0);
}

TEST(LinearBonds, SumsOfForcesAndMomentsVanishAndThreadsDoNotMatter) {
  System one(points_of(3), setting_of(3, 3.015, VolumeCorrection::linear), 1);
  System three(points_of(3), setting_of(3, 3.015, VolumeCorrection::linear), 3);
  const std::vector<double> u = one.random(5);
  std::vector<double> force(u.size()), again(u.size());
  one.bonds.find_forces(u, force);
  three.bonds.find_forces(u, again);
  EXPECT_EQ(force, again);
  double sum = 0.0, moment = 0.0;
  for (Index i = 0; i < one.body.points.count(); ++i) {
    const Coordinates at = one.body.points.position(i);
    sum += force[i * 3];
    moment += at[0] * force[i * 3 + 1] - at[1] * force[i * 3];
  }
  const double scale = tests::norm(force);
  ASSERT_GT(scale, 0.0);
  EXPECT_NEAR(sum, 0.0, 1e-12 * scale);
  EXPECT_NEAR(moment, 0.0, 1e-12 * scale);
}

TEST(LinearBonds, OfPeriodicBodiesSeeTheirImages) {
  // A wave that fits into the period: its force is its symbol times itself.
  const Points points = points_of(1);  // 20 places
  const BoxBody body(points, setting_of(1, 3.015, VolumeCorrection::none));
  const LatticeBox box = System::box_of(points);
  const std::vector<LatticeSpring> springs = System::springs_of(body);
  ASSERT_EQ(springs.size(), 3U);
  LinearBonds bonds(box, {true, false, false}, springs, 1);
  const double wave = 2.0 * std::numbers::pi * 3.0 / 20.0;
  std::vector<double> u, force(20);
  for (const Index place : box.place) u.push_back(std::sin(wave * box.numbers(place)[0]));
  bonds.find_forces(u, force);
  double symbol = 0.0;
  for (const LatticeSpring& spring : springs) {
    symbol += 2.0 * spring.stiffness * (1.0 - std::cos(wave * spring.step[0]));
  }
  ASSERT_GT(symbol, 0.0);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_NEAR(force[i], -symbol * u[i], 1e-13 * symbol);
  EXPECT_THROW(LinearBonds(System::box_of(points_of(2)), {false, true, false},
                           std::vector<LatticeSpring>{{{0, 10, 0}, {0.0, 1.0}, 1.0}}, 1),
               std::logic_error);
}

LinearBonds bonds_of(const HoledBody& body) {
  return LinearBonds(
      body.box, open,
      lattice_springs(body.kernel, body.points.spacing, body.points.angle, 2.3, body.volume()), 1);
}

/// Bond by bond, none of which is cut.
tests::ForcesAndEnergies direct(const HoledBody& body, const std::vector<double>& q,
                                const std::vector<double>& u) {
  const int d = body.dimension();
  tests::ForcesAndEnergies sums{std::vector<double>(u.size()), std::vector<double>(q.size())};
  for (const tests::Neighbour& of : tests::neighbours(body)) {
    const double r2 = of.xi[0] * of.xi[0] + of.xi[1] * of.xi[1] + of.xi[2] * of.xi[2];
    const double along = tests::along_difference(of.xi, of, u, d) / r2;
    const double stiffness = q[of.i] * q[of.j] * 2.3 * of.share / std::sqrt(r2);
    sums.energy[of.i] += 0.25 * stiffness * along * along * r2;
    for (std::size_t c = 0; c < std::size_t(d); ++c) {
      sums.force[of.i * std::size_t(d) + c] += stiffness * along * of.xi[c];
    }
  }
  return sums;
}

TEST(LinearBonds, AreThoseThatNoCrackHasCut) {
  for (const tests::HoledSetting& setting : tests::holed_settings()) {
    const HoledBody body(setting);
    SCOPED_TRACE(::testing::PrintToString(setting.counts));
    EXPECT_EQ(body.box.cut.empty(), !setting.is_cut);
    const std::vector<double> u = body.random(5), v = body.random(6);
    LinearBonds bonds = bonds_of(body);
    for (const std::vector<double>& q : {std::vector<double>(body.count(), 1.0), body.mask()}) {
      bonds.set_integrity(q);
      tests::expect_equal(tests::evaluate(bonds, u, body.count()), direct(body, q, u), 1e-13);
      tests::expect_tangent_of_forces(bonds, u, v, body.count());
    }
  }
}

/// Steps of a body with a hole, a crack and points of every integrity, of mass 1, by velocity
/// Verlet.
struct Motion {
  LinearBonds& bonds;
  std::vector<double> u, v, force;

  Motion(LinearBonds& of, const std::vector<double>& start)
      : bonds(of), u(start), v(start.size(), 0.0), force(start.size()) {
    bonds.find_forces(u, force);
  }
  void step(double dt) {
    for (std::size_t k = 0; k < u.size(); ++k) {
      v[k] += 0.5 * dt * force[k];
      u[k] += dt * v[k];
    }
    bonds.find_forces(u, force);
    for (std::size_t k = 0; k < u.size(); ++k) v[k] += 0.5 * dt * force[k];
  }
  /// What the scheme keeps of linear forces: kinetic and stored energy less dt^2 f^2 / 8.
  [[nodiscard]] double shadow_energy(double dt) const {
    return 0.5 * tests::dot(v, v) - 0.5 * tests::dot(u, force) -
           0.125 * dt * dt * tests::dot(force, force);
  }
};

TEST(LinearBonds, MoveWithAShadowEnergyUpToTheCriticalStepAndNotBeyond) {
  const HoledBody body({{13, 10}, 3.015, VolumeCorrection::none, 0.0, 0.1, true});
  LinearBonds bonds = bonds_of(body);
  bonds.set_integrity(body.mask());
  const std::vector<double> start = body.random(5);
  Eigen::MatrixXd K(start.size(), start.size());
  std::vector<double> unit(start.size(), 0.0), column(start.size());
  for (std::size_t k = 0; k < unit.size(); ++k) {
    unit[k] = 1.0;
    bonds.multiply(unit, unit, column);
    unit[k] = 0.0;
    K.col(Eigen::Index(k)) = Eigen::Map<const Eigen::VectorXd>(column.data(), K.rows());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, Eigen::EigenvaluesOnly);
  const double critical = 2.0 / std::sqrt(solver.eigenvalues().maxCoeff());
  Motion stable(bonds, start);
  const double energy = stable.shadow_energy(0.99 * critical);
  ASSERT_GT(energy, 0.0);
  for (int step = 0; step < 2000; ++step) {
    stable.step(0.99 * critical);
    ASSERT_NEAR(stable.shadow_energy(0.99 * critical), energy, 1e-12 * energy) << step;
  }
  EXPECT_LT(tests::norm(stable.u), 20.0 * tests::norm(start));
  Motion unstable(bonds, start);
  for (int step = 0; step < 200; ++step) unstable.step(1.02 * critical);
  EXPECT_GT(tests::norm(unstable.u), 1e6 * tests::norm(start));
}

}  // namespace
}  // namespace peristat
