#include "assembly/convolutions/green_bonds.hpp"

#include "assembly/convolutions/linear_bonds.hpp"
#include "tests/lattice_systems.hpp"

namespace peristat {
namespace {

using tests::both_dimensions;
using tests::ForcesAndEnergies;
using tests::HoledBody;
using tests::Neighbour;
using tests::open;

constexpr double micromodulus_of_all = 2.3;

std::vector<LatticeSpring> springs_of(const HoledBody& body) {
  return lattice_springs(body.kernel, body.points.spacing, body.points.angle, micromodulus_of_all,
                         body.volume());
}

GreenBonds bonds_of(const HoledBody& body, int threads = 1) {
  return GreenBonds(body.box, open, springs_of(body), threads);
}

/// Bond by bond, from the stretch: psi = c w r e^2 / 2, half of it at each end.
ForcesAndEnergies direct(const HoledBody& body, const std::vector<double>& q,
                         const std::vector<double>& u) {
  const auto d = std::size_t(body.dimension());
  ForcesAndEnergies sums{std::vector<double>(u.size()), std::vector<double>(q.size())};
  for (const Neighbour& of : tests::neighbours(body)) {
    std::array<double, 3> now = of.xi;
    for (std::size_t c = 0; c < d; ++c) now[c] += u[of.j * d + c] - u[of.i * d + c];
    double r2 = 0.0, change = 0.0;
    for (std::size_t c = 0; c < d; ++c) {
      r2 += of.xi[c] * of.xi[c];
      change += (now[c] - of.xi[c]) * (now[c] + of.xi[c]);
    }
    const double r = std::sqrt(r2), stretch = change / (2.0 * r2);
    const double weight = q[of.i] * q[of.j] * micromodulus_of_all * of.share;
    sums.energy[of.i] += 0.25 * weight * r * stretch * stretch;
    for (std::size_t c = 0; c < d; ++c) {
      sums.force[of.i * d + c] += weight / r * stretch * now[c];
    }
  }
  return sums;
}

TEST(GreenBonds, AreTheDirectSumsOverBonds) {
  std::vector<tests::HoledSetting> settings = tests::holed_settings();
  settings.push_back({{17}, 3.015, VolumeCorrection::linear});
  for (const tests::HoledSetting& setting : settings) {
    const HoledBody body(setting);
    SCOPED_TRACE(::testing::PrintToString(setting.counts));
    const std::vector<double> u = body.random(5);
    GreenBonds bonds = bonds_of(body);
    for (const std::vector<double>& q : {std::vector<double>(body.count(), 1.0), body.mask()}) {
      bonds.set_integrity(q);
      tests::expect_equal(tests::evaluate(bonds, u, body.count()), direct(body, q, u), 1e-13);
      tests::expect_same_without_energies(bonds, u, body.count());
    }
  }
}

TEST(GreenBonds, HaveTheForcesAndTheTangentOfTheirEnergy) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    const std::vector<double> u = body.random(5), v = body.random(6), w = body.random(7);
    GreenBonds bonds = bonds_of(body);
    bonds.set_integrity(body.mask());
    tests::expect_forces_of_energy(bonds, u, v, body.count());
    tests::expect_tangent_of_forces(bonds, u, v, body.count());
    tests::expect_symmetric_tangent(bonds, u, v, w);
  }
}

TEST(GreenBonds, AreLinearBondsAtRest) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts, 3.015});
    GreenBonds bonds = bonds_of(body);
    LinearBonds linear(body.box, open, springs_of(body), 1);
    const std::vector<double> v = body.random(5), rest(v.size(), 0.0);
    std::vector<double> product(v.size()), force(v.size());
    bonds.multiply(rest, v, product);
    linear.find_forces(v, force);
    for (double& entry : force) entry = -entry;
    ASSERT_GT(tests::norm(force), 0.0);
    EXPECT_LE(tests::distance(product, force), 1e-13 * tests::norm(force));
  }
}

TEST(GreenBonds, OutlineTheirTangent) {
  for (const std::vector<int>& counts : {std::vector<int>{9, 8}, std::vector<int>{5, 6, 5}}) {
    const HoledBody body({counts});
    GreenBonds bonds = bonds_of(body);
    tests::expect_outline(bonds, body, 1.5);
    tests::expect_outline(bonds, body, 2.5, body.random(5));
    bonds.set_integrity(body.mask());
    tests::expect_outline(bonds, body, 1.5);
    tests::expect_outline(bonds, body, 2.5, body.random(5));
  }
}

TEST(GreenBonds, TellTheirMemoryBeforehand) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    GreenBonds bonds = bonds_of(body);
    const std::vector<double> u = body.random(5);
    std::vector<double> product(u.size());
    tests::evaluate(bonds, u, body.count());
    bonds.multiply(u, u, product);
    const double expected = GreenBonds::expected_bytes(body.box, springs_of(body));
    EXPECT_NEAR(bonds.bytes() / expected, 1.0, 0.1);
  }
}

TEST(GreenBonds, TurnWithTheBody) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    GreenBonds bonds = bonds_of(body);
    // Displacements of several horizons cost digits: energies have an error of 2e-10.
    tests::expect_to_turn_with_the_body(bonds, body, 1e-9);
  }
}

TEST(GreenBonds, HaveForcesAndMomentsThatAddUpToNothing) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts, 3.015});
    GreenBonds bonds = bonds_of(body);
    bonds.set_integrity(body.mask());
    const std::vector<double> u = body.random(5);
    const auto d = std::size_t(body.dimension());
    const std::vector<double> force = tests::evaluate(bonds, u, body.count()).force;
    EXPECT_LE(tests::sum_of_forces(force, body.dimension()), 1e-13 * tests::norm(force));
    double moment = 0.0;  // about where points are now
    for (std::size_t i = 0; i < body.count(); ++i) {
      const Coordinates at = body.points.position(Index(i));
      moment += (at[0] + u[i * d]) * force[i * d + 1] - (at[1] + u[i * d + 1]) * force[i * d];
    }
    EXPECT_LE(std::abs(moment), 1e-13 * tests::norm(force));
  }
}

TEST(GreenBonds, LoseNoDigitsFarAwayAndNothingByThreads) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts, 3.015});
    GreenBonds one = bonds_of(body, 1), two = bonds_of(body, 2);
    const std::vector<double> u = body.random(5), v = body.random(6);
    const ForcesAndEnergies a = tests::evaluate(one, u, body.count());
    const ForcesAndEnergies b = tests::evaluate(two, u, body.count());
    EXPECT_EQ(a.force, b.force);
    EXPECT_EQ(a.energy, b.energy);
    std::vector<double> of_one(u.size()), of_two(u.size());
    one.multiply(u, v, of_one);
    two.multiply(u, v, of_two);
    EXPECT_EQ(of_one, of_two);
    tests::expect_same_far_away(one, u, body.dimension(), body.count(), 1e-12);
  }
}

TEST(GreenBonds, AreNothingWithoutNeighbours) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    GreenBonds bonds = bonds_of(body);
    tests::expect_nothing_at_lonely_points(bonds, body);
  }
}

TEST(GreenBonds, TakeSoManyTransforms) {
  const std::array<std::array<std::size_t, 2>, 2> expected{{{7, 18}, {11, 33}}};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto [integrity, forces] = expected[k];
    const HoledBody body({both_dimensions()[k]});
    GreenBonds bonds = bonds_of(body);
    std::size_t all = integrity;
    EXPECT_EQ(bonds.fields().transforms(), all);
    std::vector<double> u = body.random(5), v = body.random(6), found(u.size());
    bonds.find_forces(u, found);
    EXPECT_EQ(bonds.fields().transforms(), all += forces);
    bonds.multiply(u, v, found);
    EXPECT_EQ(bonds.fields().transforms(), all += forces);
    bonds.multiply(v, u, found);
    EXPECT_EQ(bonds.fields().transforms(), all += 2 * forces);
    tests::evaluate(bonds, u, body.count());
    EXPECT_EQ(bonds.fields().transforms(), all += forces + 2);
    EXPECT_GT(bonds.bytes(), 8.0 * double(u.size()));
  }
}

TEST(GreenBonds, RememberNothingElse) {
  const HoledBody body({{13, 10}});
  GreenBonds used = bonds_of(body), fresh = bonds_of(body);
  tests::expect_to_remember_nothing_else(used, fresh, body);
}

TEST(GreenBonds, HaveTheVirialsOfTheirEnergies) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    GreenBonds bonds = bonds_of(body);
    bonds.set_integrity(body.mask());
    tests::expect_virials_of_energies(bonds, body, 1e-11);
  }
}

TEST(GreenBonds, SeeImages) {
  const HoledBody body({{9, 9}, 3.015});
  tests::expect_to_see_images([&](const LatticeBox& box, const std::array<bool, 3>& periods) {
    return std::make_unique<GreenBonds>(box, periods, springs_of(body), 1);
  });
}

}  // namespace
}  // namespace peristat
