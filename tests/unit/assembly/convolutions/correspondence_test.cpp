#include "assembly/convolutions/correspondence.hpp"

#include <Eigen/Dense>

#include "tests/lattice_systems.hpp"

namespace peristat {
namespace {

using tests::both_dimensions;
using tests::ForcesAndEnergies;
using tests::HoledBody;
using tests::Neighbour;
using tests::open;

/// A stabilisation about as stiff as the material, so that neither hides the other.
Correspondence::Setting setting_of(const HoledBody& body) {
  return {{1.7, 0.9}, body.volume(), std::pow(body.kernel.horizon, -2.0 - body.dimension())};
}

Correspondence material_of(const HoledBody& body, int threads = 1) {
  return Correspondence(body.box, open, body.arms(), setting_of(body), threads);
}

/// Neighbour by neighbour, as the formulas are written.
template <int D>
struct Direct {
  using V = Eigen::Matrix<double, D, 1>;
  using T = Eigen::Matrix<double, D, D>;

  const HoledBody& body;
  const std::vector<double>&q, &u;
  std::vector<Neighbour> all = tests::neighbours(body);
  std::vector<T> F, stress;  // P K^-1

  Direct(const HoledBody& of_all, const std::vector<double>& integrity,
         const std::vector<double>& displacement)
      : body(of_all), q(integrity), u(displacement) {
    double whole = 0.0;
    for (const LatticeArm& arm : body.arms())
      whole += 2.0 * arm.share * vector(arm.xi).squaredNorm() / D;
    std::vector<T> shape(q.size(), T::Zero()), moment = shape;
    for (const Neighbour& of : all) {
      const V xi = vector(of.xi);
      shape[of.i] += q[of.j] * of.share * xi * xi.transpose();
      moment[of.i] += q[of.j] * of.share * (xi + difference(of)) * xi.transpose();
    }
    for (std::size_t i = 0; i < q.size(); ++i) {
      F.push_back(T::Identity());
      stress.push_back(T::Zero());
      if (shape[i].template selfadjointView<Eigen::Lower>().eigenvalues()[0] <= 1e-3 * whole)
        continue;
      F[i] = moment[i] * shape[i].inverse();
      stress[i] = F[i] * second(i) * shape[i].inverse();
    }
  }

  static V vector(const Coordinates& at) { return Eigen::Map<const V>(at.data()); }
  V difference(const Neighbour& of) const {
    return Eigen::Map<const V>(&u[of.j * D]) - Eigen::Map<const V>(&u[of.i * D]);
  }
  T strain(std::size_t i) const { return 0.5 * (F[i].transpose() * F[i] - T::Identity()); }
  T second(std::size_t i) const {
    const auto& [lambda, mu] = setting_of(body).constants;
    return lambda * strain(i).trace() * T::Identity() + 2.0 * mu * strain(i);
  }

  ForcesAndEnergies sums() const {
    const Correspondence::Setting setting = setting_of(body);
    const double beta = setting.stabilisation;
    ForcesAndEnergies found{std::vector<double>(u.size()), std::vector<double>(q.size())};
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (stress[i].isZero(0.0)) continue;
      found.energy[i] = 0.5 * q[i] * setting.volume * second(i).cwiseProduct(strain(i)).sum();
    }
    for (const Neighbour& of : all) {
      const double share = q[of.i] * q[of.j] * of.share;
      const V xi = vector(of.xi), now = xi + difference(of);
      const V here = now - F[of.i] * xi, there = -now + F[of.j] * xi;
      found.energy[of.i] += 0.5 * beta * share * here.squaredNorm();
      Eigen::Map<V>(&found.force[of.i * D]) +=
          share * (setting.volume * (stress[of.i] + stress[of.j]) * xi + beta * (here - there));
    }
    return found;
  }
};

ForcesAndEnergies direct(const HoledBody& body, const std::vector<double>& q,
                         const std::vector<double>& u) {
  return body.dimension() == 2 ? Direct<2>(body, q, u).sums() : Direct<3>(body, q, u).sums();
}

TEST(Correspondence, IsTheDirectSumsOverNeighbours) {
  for (const tests::HoledSetting& setting : tests::holed_settings()) {
    const HoledBody body(setting);
    SCOPED_TRACE(::testing::PrintToString(setting.counts));
    const std::vector<double> u = body.random(5);
    Correspondence material = material_of(body);
    for (const std::vector<double>& q : {std::vector<double>(body.count(), 1.0), body.mask()}) {
      material.set_integrity(q);
      tests::expect_equal(tests::evaluate(material, u, body.count()), direct(body, q, u), 1e-12);
      tests::expect_same_without_energies(material, u, body.count());
    }
  }
}

TEST(Correspondence, HasTheForcesAndTheTangentOfItsEnergy) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    const std::vector<double> u = body.random(5), v = body.random(9), w = body.random(7);
    Correspondence material = material_of(body);
    material.set_integrity(body.mask());
    tests::expect_forces_of_energy(material, u, v, body.count());
    tests::expect_tangent_of_forces(material, u, v, body.count());
    tests::expect_symmetric_tangent(material, u, v, w);
  }
}

TEST(Correspondence, FindsTheStressOfAUniformDeformation) {
  // W of F wherever there is an F, and no force where neighbourhoods of neighbours are whole.
  for (const std::vector<int>& counts : {std::vector<int>{17, 16}, std::vector<int>{13, 13, 12}}) {
    const HoledBody body({counts});
    const auto d = std::size_t(body.dimension());
    Correspondence material = material_of(body);
    std::vector<double> u(body.points.reference.size());
    Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
    F.topLeftCorner(int(d), int(d)) +=
        0.2 * Eigen::Matrix3d{{1.0, 2.0, 0.5}, {-1.0, -0.5, 0.3}, {0.7, 0.1, 0.4}}.topLeftCorner(
                  int(d), int(d));
    for (std::size_t k = 0; k < u.size(); ++k) {
      for (std::size_t c = 0; c < d; ++c) {
        const double entry = F(int(k % d), int(c)) - (k % d == c ? 1.0 : 0.0);
        u[k] += entry * body.points.reference[k / d * d + c];
      }
    }
    const Eigen::Matrix3d E = 0.5 * (F.transpose() * F - Eigen::Matrix3d::Identity());
    const auto& [lambda, mu] = setting_of(body).constants;
    const double whole =
        body.volume() * (0.5 * lambda * E.trace() * E.trace() + mu * E.squaredNorm());
    const ForcesAndEnergies found = tests::evaluate(material, u, body.count());
    for (const double energy : found.energy) EXPECT_NEAR(energy, whole, 1e-11 * whole);
    const double largest = tests::largest(found.force);
    std::size_t inner = 0;
    const double margin = 2.0 * body.kernel.horizon;
    const Coordinates hole = d == 2 ? Coordinates{0.5, 0.5, 0.0} : Coordinates{0.3, 0.3, 0.3};
    for (std::size_t i = 0; i < body.count(); ++i) {
      const Coordinates at = body.points.position(Index(i));
      bool is_inside =
          std::hypot(at[0] - hole[0], at[1] - hole[1], at[2] - hole[2]) > margin + 0.16;
      for (std::size_t c = 0; c < d; ++c) {
        is_inside = is_inside && at[c] > margin && at[c] < 0.1 * counts[c] - margin;
      }
      inner += is_inside;
      for (std::size_t c = 0; c < d && is_inside; ++c) {
        EXPECT_NEAR(found.force[i * d + c], 0.0, 1e-11 * largest);
      }
    }
    EXPECT_GT(inner, 0U);
  }
}

TEST(Correspondence, TurnsWithTheBody) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    Correspondence material = material_of(body);
    tests::expect_to_turn_with_the_body(material, body, 1e-11);
  }
}

TEST(Correspondence, OutlinesItsTangent) {
  for (const std::vector<int>& counts : {std::vector<int>{9, 8}, std::vector<int>{5, 6, 5}}) {
    const HoledBody body({counts});
    Correspondence material = material_of(body);
    tests::expect_outline(material, body, 20.0);
    tests::expect_outline(material, body, 60.0, body.random(5), false);
    material.set_integrity(body.mask());
    tests::expect_outline(material, body, 20.0);
    tests::expect_outline(material, body, 60.0, body.random(5), false);
  }
}

TEST(Correspondence, TellsItsMemoryBeforehand) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    Correspondence material = material_of(body);
    const std::vector<double> u = body.random(5);
    std::vector<double> product(u.size());
    tests::evaluate(material, u, body.count());
    material.multiply(u, u, product);
    const double expected = Correspondence::expected_bytes(
        body.box,
        lattice_springs(body.kernel, body.points.spacing, body.points.angle, 1.0, body.volume()));
    EXPECT_NEAR(material.bytes() / expected, 1.0, 0.1);
  }
}

TEST(Correspondence, HasForcesThatAddUpToNothing) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts, 3.015});
    Correspondence material = material_of(body);
    material.set_integrity(body.mask());
    const std::vector<double> force = tests::evaluate(material, body.random(5), body.count()).force;
    EXPECT_LE(tests::sum_of_forces(force, body.dimension()), 1e-12 * tests::norm(force));
  }
}

// Loops over points are compiled for several at once; the last points of each thread are left over,
// and rounded otherwise.
void expect_equal_to_round_off(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  double most = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  EXPECT_LE(most, 1e-14 * tests::norm(a));
}

TEST(Correspondence, LosesNoDigitsFarAwayOrByThreads) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts, 3.015});
    Correspondence one = material_of(body), two = material_of(body, 2);
    const std::vector<double> u = body.random(5), v = body.random(6);
    const ForcesAndEnergies a = tests::evaluate(one, u, body.count());
    const ForcesAndEnergies b = tests::evaluate(two, u, body.count());
    expect_equal_to_round_off(a.force, b.force);
    expect_equal_to_round_off(a.energy, b.energy);
    std::vector<double> of_one(u.size()), of_two(u.size());
    one.multiply(u, v, of_one);
    two.multiply(u, v, of_two);
    expect_equal_to_round_off(of_one, of_two);
    tests::expect_same_far_away(one, u, body.dimension(), body.count(), 1e-12);
  }
}

TEST(Correspondence, IsNothingWithoutNeighbours) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    Correspondence material = material_of(body);
    tests::expect_nothing_at_lonely_points(material, body);
  }
}

TEST(Correspondence, HasNoStressWhereNeighboursStandInALine) {
  const HoledBody body({{13, 10}});
  std::vector<double> q(body.count(), 0.0);
  for (std::size_t i = 0; i < q.size(); ++i) {
    q[i] = body.box.numbers(body.box.place[i])[1] == 1 ? 1.0 : 0.0;
  }
  Correspondence material = material_of(body);
  material.set_integrity(q);
  const std::vector<double> u = body.random(5), v = body.random(6);
  const ForcesAndEnergies found = tests::evaluate(material, u, body.count());
  tests::expect_equal(found, direct(body, q, u), 1e-12);
  // The stabilisation alone is quadratic.
  EXPECT_NEAR(found.total(), -0.5 * tests::dot(found.force, u), 1e-12 * found.total());
  tests::expect_tangent_of_forces(material, u, v, body.count());
  tests::expect_outline(material, body, 16.0);
}

TEST(Correspondence, TakesSoManyTransforms) {
  struct Expected {
    std::size_t integrity, forces, energies, product_elsewhere, outline;
  };
  const std::array<Expected, 2> expected{Expected{7, 12, 4, 6, 20}, Expected{11, 24, 5, 12, 53}};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& [integrity, forces, energies, elsewhere, outline] = expected[k];
    const HoledBody body({both_dimensions()[k]});
    Correspondence material = material_of(body);
    std::size_t all = integrity;
    EXPECT_EQ(material.fields().transforms(), all);
    const std::vector<double> u = body.random(5), v = body.random(6);
    std::vector<double> found(u.size()), blocks(u.size() * std::size_t(body.dimension()));
    material.find_forces(u, found);
    EXPECT_EQ(material.fields().transforms(), all += forces);
    material.multiply(u, v, found);
    EXPECT_EQ(material.fields().transforms(), all += forces);
    material.multiply(v, u, found);
    EXPECT_EQ(material.fields().transforms(), all += forces + elsewhere);
    tests::evaluate(material, u, body.count());
    EXPECT_EQ(material.fields().transforms(), all += forces + energies);
    material.outline_tangent(u, blocks, found);
    EXPECT_EQ(material.fields().transforms(), all += outline);
    EXPECT_GT(material.bytes(), 8.0 * double(u.size()));
  }
}

TEST(Correspondence, RemembersNothingElse) {
  const HoledBody body({{13, 10}});
  Correspondence used = material_of(body), fresh = material_of(body);
  tests::expect_to_remember_nothing_else(used, fresh, body);
}

TEST(Correspondence, HasTheVirialsOfItsEnergies) {
  for (const std::vector<int>& counts : both_dimensions()) {
    const HoledBody body({counts});
    Correspondence material = material_of(body);
    material.set_integrity(body.mask());
    tests::expect_virials_of_energies(material, body, 1e-11);
  }
}

TEST(Correspondence, SeesImages) {
  const HoledBody body({{9, 9}, 3.015});
  tests::expect_to_see_images([&](const LatticeBox& box, const std::array<bool, 3>& periods) {
    return std::make_unique<Correspondence>(box, periods, body.arms(), setting_of(body), 1);
  });
}

TEST(Correspondence, IsOfPlanesAndSpaces) {
  const LatticeBox bar = tests::bar(4);
  const std::vector<LatticeArm> arms{{{1, 0, 0}, {0.1, 0.0, 0.0}, 1.0}};
  EXPECT_THROW(Correspondence(bar, open, arms, {{1.0, 1.0}, 1.0, 1.0}, 1), std::logic_error);
  EXPECT_THROW(Correspondence(tests::rectangle(3, 9), {true, false, false},
                              std::vector<LatticeArm>{{{3, 0, 0}, {0.3, 0.0, 0.0}, 1.0}},
                              {{1.0, 1.0}, 1.0, 1.0}, 1),
               std::logic_error);
}

}  // namespace
}  // namespace peristat
