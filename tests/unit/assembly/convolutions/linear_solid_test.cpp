#include "assembly/convolutions/linear_solid.hpp"

#include <memory>

#include "assembly/assembler.hpp"
#include "assembly/convolutions/linear_bonds.hpp"
#include "assembly/terms/states/state_term.hpp"
#include "tests/lattice_systems.hpp"

namespace peristat {
namespace {

using tests::both_dimensions;
using tests::ForcesAndEnergies;
using tests::HoledBody;
using tests::Neighbour;
using tests::open;

LinearSolid::Setting setting_of(const HoledBody& body, SolidForces form = SolidForces::energy) {
  return {{1.7, 0.9}, body.volume(), form};
}

LinearSolid solid_of(const HoledBody& body, SolidForces form = SolidForces::energy,
                     int threads = 1) {
  return LinearSolid(body.box, open, body.arms(), setting_of(body, form), threads);
}

/// Neighbour by neighbour, as the formulas are written.
ForcesAndEnergies direct(const HoledBody& body, const std::vector<double>& q,
                         const std::vector<double>& u, SolidForces form) {
  const int d = body.dimension();
  const auto& [lambda, mu] = setting_of(body).constants;
  const double V = body.volume();
  const std::vector<Neighbour> all = tests::neighbours(body);
  std::vector<double> moment(q.size()), theta(q.size()), squares(q.size());
  const auto squared = [](const Neighbour& of) {
    return of.xi[0] * of.xi[0] + of.xi[1] * of.xi[1] + of.xi[2] * of.xi[2];
  };
  for (const Neighbour& of : tests::neighbours(body, true)) {
    moment[of.i] += q[of.j] * of.share * squared(of);
  }
  for (const Neighbour& of : all) {
    if (moment[of.i] == 0.0) continue;
    const double along = tests::along_difference(of.xi, of, u, d);
    const double share = q[of.j] * of.share / moment[of.i];
    theta[of.i] += d * share * along;
    squares[of.i] += share * along * along / squared(of);
  }
  ForcesAndEnergies sums{std::vector<double>(u.size()), std::vector<double>(q.size())};
  for (std::size_t i = 0; i < q.size(); ++i) {
    sums.energy[i] =
        0.5 * q[i] * V * ((lambda - mu) * theta[i] * theta[i] + d * (d + 2) * mu * squares[i]);
  }
  for (const Neighbour& of : all) {
    if (q[of.i] * q[of.j] == 0.0) continue;
    const double here = moment[of.i], there = form == SolidForces::energy ? moment[of.j] : here;
    const double pressure = d * (lambda - mu) * (theta[of.i] / here + theta[of.j] / there);
    const double along = tests::along_difference(of.xi, of, u, d) / squared(of);
    const double deviatoric = d * (d + 2) * mu * (1.0 / here + 1.0 / there) * along;
    const double pull = q[of.i] * q[of.j] * V * of.share * (pressure + deviatoric);
    for (int c = 0; c < d; ++c) {
      sums.force[of.i * std::size_t(d) + std::size_t(c)] += pull * of.xi[std::size_t(c)];
    }
  }
  return sums;
}

TEST(LinearSolid, IsTheDirectSumsOverNeighbours) {
  for (const tests::HoledSetting& setting : tests::holed_settings()) {
    const HoledBody body(setting);
    SCOPED_TRACE(::testing::PrintToString(setting.counts));
    ASSERT_LT(body.count(), body.box.count());
    const std::vector<double> u = body.random(5);
    for (const SolidForces form : {SolidForces::energy, SolidForces::printed}) {
      LinearSolid solid = solid_of(body, form);
      for (const std::vector<double>& q : {std::vector<double>(body.count(), 1.0), body.mask()}) {
        solid.set_integrity(q);
        const ForcesAndEnergies expected = direct(body, q, u, form);
        tests::expect_equal(tests::evaluate(solid, u, body.count()), expected, 1e-13);
        tests::expect_same_without_energies(solid, u, body.count());
      }
    }
  }
}

TEST(LinearSolid, IsTheEnergyOfStatesWithMomentsOfTheNeighboursThatAreThere) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts, 3.015, VolumeCorrection::linear});
    // Weights of bonds have K r beside the volumes.
    BondSetting bonds_setting;
    static_cast<Kernel&>(bonds_setting) = body.kernel;
    bonds_setting.influence = [](double x) { return x; };
    const auto bonds = std::make_shared<const Bonds>(
        make_bonds(body.points, SurfaceCorrection::none, bonds_setting, 1));
    StateShares shares;
    shares.whole = bonds->kind;
    shares.moment = moments_of(body.points, *bonds);
    const LinearSolid::Setting setting = setting_of(body);
    shares.constants.assign(body.count(), setting.constants);
    const Model model(std::shared_ptr<Term>(std::make_shared<StateTerm>(
        bonds, BondPotential(Harmonic{1.0}), std::vector<char>(), shares, StateRules{}, 1)));
    Assembler assembler(body.points, model, 1);
    LinearSolid solid = solid_of(body);
    const std::vector<double> u = body.random(5);
    std::vector<double> gradient(u.size());
    const double energy = assembler.gradient(u, gradient).energy;
    ForcesAndEnergies found = tests::evaluate(solid, u, body.count());
    for (double& entry : found.force) entry = -entry;
    ASSERT_GT(energy, 0.0);
    EXPECT_NEAR(found.total(), energy, 1e-13 * energy);
    EXPECT_LE(tests::distance(found.force, gradient), 1e-13 * tests::norm(gradient));
  }
}

TEST(LinearSolid, HasTheForcesAndTheTangentOfItsEnergy) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    const std::vector<double> u = body.random(5), v = body.random(6), w = body.random(7);
    LinearSolid solid = solid_of(body);
    solid.set_integrity(body.mask());
    tests::expect_forces_of_energy(solid, u, v, body.count());
    tests::expect_tangent_of_forces(solid, u, v, body.count());
    tests::expect_symmetric_tangent(solid, u, v, w);
    LinearSolid printed = solid_of(body, SolidForces::printed);
    printed.set_integrity(body.mask());
    tests::expect_tangent_of_forces(printed, u, v, body.count());
  }
}

TEST(LinearSolid, OutlinesItsTangent) {
  for (const std::vector<int>& counts : {std::vector<int>{9, 8}, std::vector<int>{5, 6, 5}}) {
    const HoledBody body({counts});
    for (const SolidForces form : {SolidForces::energy, SolidForces::printed}) {
      LinearSolid solid = solid_of(body, form);
      tests::expect_outline(solid, body, 4.0);
      solid.set_integrity(body.mask());
      tests::expect_outline(solid, body, 4.0);
    }
  }
}

TEST(LinearSolid, HasForcesThatAddUpToNothingButThePrintedOnesDoNot) {
  const HoledBody body({{13, 10}, 3.015});
  const std::vector<double> u = body.random(5);
  for (const SolidForces form : {SolidForces::energy, SolidForces::printed}) {
    LinearSolid solid = solid_of(body, form);
    const std::vector<double> force = tests::evaluate(solid, u, body.count()).force;
    const double sum = tests::sum_of_forces(force, 2) / tests::norm(force);
    double moment = 0.0;
    for (Index i = 0; i < body.points.count(); ++i) {
      const Coordinates at = body.points.position(i);
      moment += at[0] * force[2 * std::size_t(i) + 1] - at[1] * force[2 * std::size_t(i)];
    }
    if (form == SolidForces::energy) {
      EXPECT_LE(sum, 1e-13);
      EXPECT_LE(std::abs(moment), 1e-13 * tests::norm(force));
    } else {
      EXPECT_GT(sum, 1e-3);
    }
  }
}

TEST(LinearSolid, FindsTheDilatationOfAUniformOneEverywhere) {
  // w = d^2 (lambda + 2 mu / d) e^2 V / 2 of u = e x, however many neighbours are left.
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    LinearSolid solid = solid_of(body);
    const std::vector<double> q = body.mask();
    solid.set_integrity(q);
    std::vector<double> u = body.points.reference;
    for (double& entry : u) entry *= 1e-3;
    const auto& [lambda, mu] = setting_of(body).constants;
    const double d = body.dimension();
    const double whole = 0.5 * d * d * (lambda + 2.0 * mu / d) * 1e-6 * body.volume();
    const std::vector<double> energy = tests::evaluate(solid, u, body.count()).energy;
    for (std::size_t i = 1; i < q.size(); ++i) {
      EXPECT_NEAR(energy[i], q[i] * whole, 1e-10 * whole) << i;
    }
  }
}

TEST(LinearSolid, LosesNoDigitsFarAwayAndNothingByThreads) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts, 3.015});
    LinearSolid one = solid_of(body, SolidForces::energy, 1),
                two = solid_of(body, SolidForces::energy, 2);
    std::vector<double> u = body.random(5);
    const ForcesAndEnergies a = tests::evaluate(one, u, body.count());
    const ForcesAndEnergies b = tests::evaluate(two, u, body.count());
    EXPECT_EQ(a.force, b.force);
    EXPECT_EQ(a.energy, b.energy);
    for (double& entry : u) entry *= 1e-2;
    tests::expect_same_far_away(one, u, body.dimension(), body.count(), 1e-12);
  }
}

TEST(LinearSolid, IsNothingWithoutNeighbours) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    for (const SolidForces form : {SolidForces::energy, SolidForces::printed}) {
      LinearSolid solid = solid_of(body, form);
      tests::expect_nothing_at_lonely_points(solid, body);
    }
  }
}

TEST(LinearSolid, TakesSoManyTransforms) {
  const HoledBody plane({{13, 10}}), space({{7, 6, 9}});
  struct Expected {
    const HoledBody& body;
    SolidForces form;
    std::size_t integrity, forces, energies;
  };
  for (const Expected& expected : {Expected{plane, SolidForces::energy, 11, 10, 14},
                                   Expected{space, SolidForces::energy, 18, 14, 21},
                                   Expected{plane, SolidForces::printed, 11, 6, 12},
                                   Expected{space, SolidForces::printed, 18, 8, 18}}) {
    LinearSolid solid = solid_of(expected.body, expected.form);
    EXPECT_EQ(solid.fields().transforms(), expected.integrity);
    std::vector<double> u = expected.body.random(5), force(u.size());
    solid.find_forces(u, force);
    EXPECT_EQ(solid.fields().transforms(), expected.integrity + expected.forces);
    tests::evaluate(solid, u, expected.body.count());
    EXPECT_EQ(solid.fields().transforms(),
              expected.integrity + expected.forces + expected.energies);
    EXPECT_GT(solid.bytes(), 8.0 * double(u.size()));
  }
}

TEST(LinearSolid, IsOfPlanesAndSpaces) {
  const LatticeBox bar = tests::bar(4);
  const std::vector<LatticeArm> arms{{{1, 0, 0}, {0.1, 0.0, 0.0}, 1.0}};
  EXPECT_THROW(LinearSolid(bar, open, arms, {{1.0, 1.0}, 1.0}, 1), std::logic_error);
}

TEST(LinearSolid, IsOneOfBondsWhereLambdaIsMuAndNeighbourhoodsAreWhole) {
  // Poisson's ratio 1/4: no forces of dilatations, and k = 2 d (d + 2) mu V kappa / M.
  const HoledBody body({{7, 6, 9}, 2.015, VolumeCorrection::linear});
  LatticeBox box;
  box.dimension = 3;
  box.extent = {7, 6, 9};
  for (Index place = 0; place < 7 * 6 * 9; ++place) box.place.push_back(place);
  const std::vector<LatticeArm> arms = body.arms();
  double moment = 0.0;
  for (const LatticeArm& arm : arms) {
    moment += 2.0 * arm.share * tests::dot(arm.xi, arm.xi);
  }
  const double mu = 0.9, V = body.volume();
  std::vector<LatticeSpring> springs;
  for (const LatticeArm& arm : arms) {
    const double length = tests::norm(arm.xi);
    const Coordinates n{arm.xi[0] / length, arm.xi[1] / length, arm.xi[2] / length};
    springs.push_back({arm.step, n, arm.xi, 2.0 * 3 * 5 * mu * V * arm.share / moment});
  }
  const std::array<bool, 3> everywhere{true, true, true};
  LinearSolid solid(box, everywhere, arms, {{mu, mu}, V}, 1);
  LinearBonds bonds(box, everywhere, springs, 1);
  const std::vector<double> u = tests::Random(5).vector(3 * box.place.size(), 0.01);
  ForcesAndEnergies expected{std::vector<double>(u.size()), std::vector<double>(box.place.size())};
  bonds.find_forces_and_energies(u, expected.force, expected.energy);
  tests::expect_equal(tests::evaluate(solid, u, box.place.size()), expected, 1e-13);
}

/// nu = 1/4 in space, 1/3 in plane stress: nothing is left of the dilatation, whatever a
/// neighbourhood lacks ([FCBM] 5.6).
TEST(LinearSolid, IsBondsWithTheMomentsOfBothEndsWhereLambdaIsMu) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts, 2.015, VolumeCorrection::linear, 0.0, 0.1, true});
    const auto d = std::size_t(body.dimension());
    const double mu = 0.9, shear = double(d * (d + 2)) * mu * body.volume();
    LinearSolid solid(body.box, open, body.arms(), {{mu, mu}, body.volume()}, 1);
    const std::vector<double> u = body.random(5), q = body.mask();
    solid.set_integrity(q);
    const std::vector<Neighbour> all = tests::neighbours(body);
    const auto squared = [](const Neighbour& of) {
      return of.xi[0] * of.xi[0] + of.xi[1] * of.xi[1] + of.xi[2] * of.xi[2];
    };
    std::vector<double> moment(body.count());
    for (const Neighbour& of : tests::neighbours(body, true)) {
      moment[of.i] += q[of.j] * of.share * squared(of);
    }
    ForcesAndEnergies bonds{std::vector<double>(u.size()), std::vector<double>(body.count())};
    for (const Neighbour& of : all) {
      if (q[of.i] * q[of.j] == 0.0) continue;
      const double weight = q[of.i] * q[of.j] * shear * of.share;
      const double stiffness = weight * (1.0 / moment[of.i] + 1.0 / moment[of.j]);
      const double along = tests::along_difference(of.xi, of, u, int(d)) / squared(of);
      bonds.energy[of.i] += 0.5 * weight / moment[of.i] * along * along * squared(of);
      for (std::size_t c = 0; c < d; ++c) {
        bonds.force[of.i * d + c] += stiffness * along * of.xi[c];
      }
    }
    tests::expect_equal(tests::evaluate(solid, u, body.count()), bonds, 1e-12);
  }
}

/// Moments are renewed: what has failed might as well never have been there, which a bond that
/// breaks by itself, of StateTerm, might not.
TEST(LinearSolid, WithoutIntegrityIsTheBodyWithoutThePoint) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts, 2.015});
    std::vector<double> q(body.count(), 1.0);
    for (std::size_t i = 3; i < q.size(); i += 11) q[i] = 0.0;
    LinearSolid damaged = solid_of(body);
    damaged.set_integrity(q);
    LatticeBox rest = body.box;
    rest.place.clear();
    const auto d = std::size_t(body.dimension());
    const std::vector<double> u = body.random(5);
    std::vector<double> u_of_rest;
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (q[i] == 0.0) continue;
      rest.place.push_back(body.box.place[i]);
      u_of_rest.insert(u_of_rest.end(), &u[i * d], &u[i * d] + d);
    }
    LinearSolid without(rest, open, body.arms(), setting_of(body), 1);
    const ForcesAndEnergies all = tests::evaluate(damaged, u, body.count());
    ForcesAndEnergies of_rest;
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (q[i] == 0.0) continue;
      of_rest.energy.push_back(all.energy[i]);
      of_rest.force.insert(of_rest.force.end(), &all.force[i * d], &all.force[i * d] + d);
    }
    tests::expect_equal(of_rest, tests::evaluate(without, u_of_rest, rest.place.size()), 1e-12);
  }
}

TEST(LinearSolid, HasTheVirialsOfItsEnergies) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    LinearSolid solid = solid_of(body);
    solid.set_integrity(body.mask());
    tests::expect_virials_of_energies(solid, body, 1e-11);
  }
}

TEST(LinearSolid, SeesImages) {
  const HoledBody body({{9, 9}, 3.015});
  for (const SolidForces form : {SolidForces::energy, SolidForces::printed}) {
    tests::expect_to_see_images([&](const LatticeBox& box, const std::array<bool, 3>& periods) {
      return std::make_unique<LinearSolid>(box, periods, body.arms(), setting_of(body, form), 1);
    });
  }
}

}  // namespace
}  // namespace peristat
