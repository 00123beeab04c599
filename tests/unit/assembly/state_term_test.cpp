// The energy of states (StateTerm): derivatives, balances, what it is known to be, damage.
#include "assembly/terms/states/state_term.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/operators/matrix_free_tangent.hpp"
#include "assembly/terms/collocation/collocation_operator.hpp"
#include "assembly/terms/collocation/make_collocation_network.hpp"
#include "src/neighbourhood/influence.hpp"
#include "src/potentials/potential.hpp"
#include "tests/bodies.hpp"
#include "tests/finite_differences.hpp"

namespace peristat {
namespace {

using tests::BoxSetting;
using tests::distance;
using tests::largest;
using tests::norm;
using tests::Random;

struct Solid {
  double lambda = 1.7, mu = 0.9;
  double lambda_right = 1.7, mu_right = 0.9;  ///< of the points beyond the middle
  std::string influence = "inverse";
  double critical = 0.0;  ///< stretch at which bonds break; 0: they don't
  StateRules rules{};
};

/// A box of points with the energy of states.
struct StateBody {
  Points points;
  BondSetting setting;
  std::shared_ptr<StateTerm> term;
  Model model;

  StateBody(const BoxSetting& box, const Solid& solid, int threads = 1)
      : points(tests::box_points(box)),
        setting(tests::bond_setting(box)),
        model(Bonds{{0}, {}, {}}) {
    setting.influence = [kernel = influence_named(solid.influence)](double x) {
      return kernel ? x * kernel(x) : x;
    };
    make(make_bonds(points, SurfaceCorrection::none, setting, threads), box, solid, threads);
  }

  void make(Bonds bonds, const BoxSetting& box, const Solid& solid, int threads) {
    StateShares shares;
    shares.whole = bonds.kind;
    shares.moment = moments_of(points, bonds);
    for (Index i = 0; i < points.count(); ++i) {
      const bool is_right = points.position(i)[0] > 0.5 * box.extent[0] * box.spacing;
      shares.constants.push_back(is_right ? LamePair{solid.lambda_right, solid.mu_right}
                                          : LamePair{solid.lambda, solid.mu});
    }
    BondPotential potential = Harmonic{1.0};
    if (solid.critical > 0.0) {
      potential = Degraded<CriticalStretch>{1.0, CriticalStretch{solid.critical}};
    }
    term =
        std::make_shared<StateTerm>(std::make_shared<const Bonds>(std::move(bonds)), potential,
                                    std::vector<char>(), std::move(shares), solid.rules, threads);
    model = Model(term);
  }

  [[nodiscard]] std::size_t dofs() const { return points.reference.size(); }

  /// Displacement of the homogeneous gradient h, row major.
  [[nodiscard]] std::vector<double> homogeneous(const std::vector<double>& h) const {
    const auto d = std::size_t(points.dimension);
    std::vector<double> u(dofs(), 0.0);
    for (std::size_t k = 0; k < u.size(); ++k) {
      for (std::size_t c = 0; c < d; ++c) {
        u[k] += h[k % d * d + c] * points.reference[k / d * d + c];
      }
    }
    return u;
  }
};

BoxSetting perturbed_box(int dimension) {
  BoxSetting box = tests::small_box(dimension);
  box.perturbation = 0.2;
  return box;
}

Solid mixed_solid() {
  Solid solid;
  solid.lambda_right = 0.2;
  solid.mu_right = 1.4;
  return solid;
}

/// The tangent as a full matrix.
Eigen::MatrixXd full(Assembler& assembler, const StateView& at, double projection = 0.0) {
  const int d = assembler.points().dimension;
  Tangent tangent(assembler);
  assembler.tangent(at, tangent, projection);
  const auto size = Eigen::Index(assembler.points().reference.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  for (Index i = 0; i < tangent.pattern.points(); ++i) {
    for (int r = 0; r < d; ++r) {
      for (int c = 0; c < d; ++c) {
        matrix(i * d + r, i * d + c) = tangent.diagonal[std::size_t((i * d + r) * d + c)];
      }
    }
    for (Offset b = tangent.pattern.offset[i]; b < tangent.pattern.offset[i + 1]; ++b) {
      const Index j = tangent.pattern.partner(i, b);
      for (int r = 0; r < d; ++r) {
        for (int c = 0; c < d; ++c) {
          matrix(i * d + r, j * d + c) = matrix(j * d + c, i * d + r) = tangent.entry(b, r, c);
        }
      }
    }
  }
  return matrix;
}

/// The bonds' part of the energy for points of one mu. The bonds of each point have its own
/// normalisation: w_ij (1/M_i + 1/M_j) / 2 in both.
Bonds bonds_alone(const StateBody& body, double mu) {
  const int d = body.points.dimension;
  Bonds bonds = body.model.bonds();
  const std::vector<double>& moment = body.term->shares().moment;
  bonds.set_weights([&](Index i, Offset bond) {
    const Index j = bonds.partner(i, bond);
    const double volumes = body.points.volume[i] / moment[std::size_t(i)] +
                           body.points.volume[j] / moment[std::size_t(j)];
    return d * (d + 2) * mu * body.term->shares().whole[bond].weight * volumes;
  });
  return bonds;
}

class StatesOfDimension : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, StatesOfDimension, ::testing::Values(2, 3));

std::vector<double> moved(std::vector<double> u, double t, const std::vector<double>& v) {
  for (std::size_t k = 0; k < u.size(); ++k) u[k] += t * v[k];
  return u;
}

void expect_derivatives(const StateBody& body, const StateView& at, double scale) {
  Assembler assembler(body.points, body.model, 2);
  const std::vector<double> u(at.displacement.begin(), at.displacement.end());
  const std::vector<double> v = Random(2).vector(body.dofs(), 0.01);
  const auto along = [&](double t) { return moved(u, t, v); };
  const auto view = [&](const std::vector<double>& there) {
    return StateView(there, at.history, at.damage, at.environment);
  };
  std::vector<double> gradient(body.dofs());
  EXPECT_GT(assembler.gradient(at, gradient).energy, 0.0);
  EXPECT_TRUE(tests::is_derivative(
      [&](double t) {
        const std::vector<double> there = along(t);
        return std::vector<double>{assembler.energy(view(there)).energy};
      },
      {tests::dot(gradient, v)}, scale));
  std::vector<double> product(body.dofs());
  assembler.product(at, v, product, 0.0);
  EXPECT_TRUE(tests::is_derivative(
      [&](double t) {
        const std::vector<double> there = along(t);
        std::vector<double> forces(body.dofs());
        static_cast<void>(assembler.gradient(view(there), forces));
        return forces;
      },
      product, scale));
  for (const double projection : {0.0, 0.4, 1.0}) {
    assembler.product(at, v, product, projection);
    const Eigen::MatrixXd matrix = full(assembler, at, projection);
    const Eigen::VectorXd stored = matrix * Eigen::Map<const Eigen::VectorXd>(v.data(), v.size());
    EXPECT_LT(distance({stored.data(), body.dofs()}, product), 1e-12 * norm(product));
  }
}

TEST_P(StatesOfDimension, GradientTangentAndProductAreDerivatives) {
  const StateBody body(perturbed_box(GetParam()), mixed_solid());
  const std::vector<double> u = Random(1).vector(body.dofs(), 0.01);
  expect_derivatives(body, u, 1.0);
  // Quadratic: half of u H u.
  Assembler assembler(body.points, body.model, 2);
  std::vector<double> gradient(body.dofs());
  const double energy = assembler.gradient(u, gradient).energy;
  EXPECT_NEAR(energy, 0.5 * tests::dot(gradient, u), 1e-13 * energy);
}

// ---- At finite strain

Solid finite_solid() {
  Solid solid = mixed_solid();
  solid.rules = {Extension::finite, DamageDrive::release};
  return solid;
}

/// A homogeneous strain of some 30 %, with disorder.
std::vector<double> large_displacement(const StateBody& body) {
  std::vector<double> gradient =
      Random(11).vector(std::size_t(body.points.dimension * body.points.dimension), 0.3);
  return moved(body.homogeneous(gradient), 1.0, Random(12).vector(body.dofs(), 0.01));
}

TEST_P(StatesOfDimension, FiniteDerivativesAreRightFarFromRest) {
  const StateBody body(perturbed_box(GetParam()), finite_solid());
  expect_derivatives(body, large_displacement(body), 0.01);
}

TEST_P(StatesOfDimension, FiniteDerivativesAreRightWithEigenstretches) {
  const StateBody body(perturbed_box(GetParam()), finite_solid());
  auto heated = std::make_shared<Environment>();
  heated->eigenstretch = Random(13).vector(body.points.volume.size(), 0.1);
  const std::vector<double> u = large_displacement(body);
  static const History none;
  expect_derivatives(body, {u, none, Damage::grows, heated}, 0.01);
}

/// A body that has expanded as its points would by themselves stores nothing.
TEST_P(StatesOfDimension, FiniteEigenstretchesAreFreeOfStress) {
  const int d = GetParam();
  const StateBody body(perturbed_box(d), finite_solid());
  Assembler assembler(body.points, body.model, 1);
  auto heated = std::make_shared<Environment>();
  heated->eigenstretch.assign(body.points.volume.size(), 0.2);
  std::vector<double> expansion(std::size_t(d * d), 0.0);
  for (int c = 0; c < d; ++c) expansion[std::size_t(c * (d + 1))] = 0.2;
  const std::vector<double> u = body.homogeneous(expansion), rest(body.dofs(), 0.0);
  std::vector<double> force(body.dofs()), held(body.dofs());
  static const History none;
  const double energy = assembler.gradient({u, none, Damage::grows, heated}, force).energy;
  EXPECT_LT(std::abs(energy),
            1e-28 * assembler.gradient({rest, none, Damage::grows, heated}, held).energy);
  EXPECT_LT(norm(force), 1e-14 * norm(held));
}

/// Rotations of any angle change no energy and turn the forces; so do they at a strained state.
TEST_P(StatesOfDimension, FiniteEnergyIsObjective) {
  const int d = GetParam();
  const StateBody body(perturbed_box(d), finite_solid());
  Assembler assembler(body.points, body.model, 1);
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(d, d);
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(2.0).toRotationMatrix();
  if (d == 3) {
    turn = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  }
  const auto turned = [&](const std::vector<double>& field) {
    std::vector<double> result(field.size());
    for (std::size_t i = 0; i < field.size(); i += std::size_t(d)) {
      Eigen::Map<Eigen::VectorXd>(&result[i], d) =
          turn * Eigen::Map<const Eigen::VectorXd>(&field[i], d);
    }
    return result;
  };
  const auto places = [&](const std::vector<double>& u) {
    return moved(u, 1.0, body.points.reference);
  };
  const auto displaced = [&](const std::vector<double>& x) {
    return moved(x, -1.0, body.points.reference);
  };

  std::vector<double> force(body.dofs()), after(body.dofs());
  const std::vector<double> u = large_displacement(body);
  const double energy = assembler.gradient(u, force).energy;
  const double turned_energy = assembler.gradient(displaced(turned(places(u))), after).energy;
  EXPECT_NEAR(turned_energy, energy, 1e-13 * energy);
  EXPECT_LT(distance(after, turned(force)), 1e-13 * norm(force));
  const double rigid = assembler.energy(displaced(turned(body.points.reference))).energy;
  EXPECT_LT(std::abs(rigid), 1e-28 * energy);
}

TEST_P(StatesOfDimension, FiniteForcesHaveNoSumAndNoMoment) {
  const int d = GetParam();
  const StateBody body(perturbed_box(d), finite_solid());
  Assembler assembler(body.points, body.model, 1);
  const std::vector<double> u = large_displacement(body), x = moved(u, 1.0, body.points.reference);
  std::vector<double> force(body.dofs());
  static_cast<void>(assembler.gradient(u, force));
  double sum[3] = {}, moment = 0.0;
  for (std::size_t i = 0; i < force.size(); i += std::size_t(d)) {
    for (int c = 0; c < d; ++c) sum[c] += force[i + std::size_t(c)];
    moment += x[i] * force[i + 1] - x[i + 1] * force[i];
  }
  for (const double component : sum) EXPECT_NEAR(component, 0.0, 1e-13 * norm(force));
  EXPECT_NEAR(moment, 0.0, 1e-13 * norm(force));
  EXPECT_TRUE(body.model.balances().moment_sum);
}

/// At rest both extensions have one tangent, and small strains give the linear forces.
TEST_P(StatesOfDimension, FiniteIsLinearAtRest) {
  Solid linear = mixed_solid();
  const BoxSetting box = perturbed_box(GetParam());
  const StateBody finite(box, finite_solid()), small(box, linear);
  Assembler of_finite(finite.points, finite.model, 1), of_small(small.points, small.model, 1);
  const std::vector<double> rest(finite.dofs(), 0.0);
  const Eigen::MatrixXd tangent = full(of_finite, rest), expected = full(of_small, rest);
  EXPECT_LT((tangent - expected).norm(), 1e-13 * expected.norm());
  double last = 0.0;
  for (const double size : {1e-4, 1e-5}) {
    const std::vector<double> u = Random(14).vector(finite.dofs(), size * box.spacing);
    std::vector<double> one(finite.dofs()), other(finite.dofs());
    static_cast<void>(of_finite.gradient(u, one));
    static_cast<void>(of_small.gradient(u, other));
    const double error = distance(one, other) / norm(other);
    if (last > 0.0) {
      EXPECT_NEAR(last / error, 10.0, 1.0);
    }
    last = error;
  }
}

/// lambda = mu: bonds with the stiffness q_i + q_j, at any strain.
TEST_P(StatesOfDimension, FiniteIsTheBondModelAtItsPoissonRatio) {
  const int d = GetParam();
  Solid solid;
  solid.lambda = solid.lambda_right = solid.mu = solid.mu_right = 0.8;
  solid.rules = {Extension::finite, DamageDrive::release};
  const StateBody body(perturbed_box(d), solid);
  const Model bond_model(bonds_alone(body, 0.8), Harmonic{1.0});
  Assembler states(body.points, body.model, 1), springs(body.points, bond_model, 1);
  const std::vector<double> u = large_displacement(body);
  std::vector<double> one(body.dofs()), other(body.dofs());
  const double energy = states.gradient(u, one).energy;
  EXPECT_NEAR(energy, springs.gradient(u, other).energy, 1e-13 * energy);
  EXPECT_LT(distance(one, other), 1e-13 * norm(other));
  const std::vector<double> v = Random(15).vector(body.dofs(), 1.0);
  states.product(u, v, one, 0.0);
  springs.product(u, v, other, 0.0);
  EXPECT_LT(distance(one, other), 1e-12 * norm(other));
}

/// Between the bonds' tangent, which preconditions, and its largest multiple.
TEST_P(StatesOfDimension, TangentLiesBetweenMultiplesOfTheBonds) {
  const int d = GetParam();
  for (const double lambda : {-0.3, 0.4, 5.0}) {
    Solid solid;
    solid.lambda = solid.lambda_right = lambda;
    solid.mu = solid.mu_right = 0.8;
    solid.rules = {Extension::finite, DamageDrive::release};
    BoxSetting box = perturbed_box(d);
    box.extent = d == 2 ? std::array{6, 5, 0} : std::array{4, 4, 3};
    const StateBody body(box, solid);
    const Model bond_model(bonds_alone(body, 0.8), Harmonic{1.0});
    Assembler states(body.points, body.model, 1), springs(body.points, bond_model, 1);
    const std::vector<double> rest(body.dofs(), 0.0);
    const Eigen::MatrixXd all = full(states, rest), bonds = full(springs, rest);
    const StateRatios ratios = state_ratios(body.term->shares().constants, d);
    const auto least = [](const Eigen::MatrixXd& of) {
      return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(of, Eigen::EigenvaluesOnly)
          .eigenvalues()[0];
    };
    EXPECT_GT(least(all - ratios.least * bonds), -1e-13 * all.norm());
    EXPECT_GT(least(ratios.most * bonds - all), -1e-13 * all.norm());
  }
}

/// Products are the stored tangent's, rows and diagonal those of the bonds alone, and their sums
/// bound its eigenvalues.
TEST_P(StatesOfDimension, TangentNeedsNoStorage) {
  const int d = GetParam();
  for (const int threads : {1, 3}) {
    Solid solid;
    solid.lambda = solid.lambda_right = 5.0;
    solid.mu = solid.mu_right = 0.8;
    solid.rules = {Extension::finite, DamageDrive::release};
    const StateBody body(perturbed_box(d), solid);
    Assembler storing(body.points, body.model, threads);
    Assembler visiting(body.points, body.model, threads, whole_body(),
                       Assembler::PatternOf::visited_rows);
    EXPECT_THROW(MatrixFreeTangent{storing}, std::logic_error);
    EXPECT_EQ(visiting.pattern().blocks(), body.model.bonds().count());
    Tangent stored(storing);
    MatrixFreeTangent free(visiting);
    const std::vector<double> v = Random(16).vector(body.dofs(), 1.0);
    std::vector<double> one(body.dofs()), other(body.dofs());
    for (const double projection : {0.0, 1.0}) {
      const std::vector<double> u = large_displacement(body);
      stored.linearise(storing, {u, {}}, projection);
      free.linearise(visiting, {u, {}}, projection);
      stored.multiply(v, one);
      free.multiply(v, other);
      EXPECT_LT(distance(one, other), 1e-13 * norm(one));
      other = v;
      ASSERT_TRUE(free.multiplies_in_place());
      free.multiply(other, other);
      EXPECT_LT(distance(one, other), 1e-13 * norm(one));
    }

    const std::vector<double> rest(body.dofs(), 0.0);
    const Model bond_model(bonds_alone(body, 0.8), Harmonic{1.0});
    Assembler springs(body.points, bond_model, threads);
    Tangent of_bonds(springs);
    of_bonds.linearise(springs, {rest, {}}, 0.0);
    free.linearise(visiting, {rest, {}}, 0.0);
    EXPECT_LT(distance(free.diagonal, of_bonds.diagonal), 1e-12 * norm(of_bonds.diagonal));
    double difference = 0.0;
    const auto entries = std::size_t(d * d);
    Assembler alone(body.points, body.model, 1, whole_body(), Assembler::PatternOf::visited_rows);
    MatrixFreeTangent by_one(alone);
    by_one.linearise(alone, {rest, {}}, 0.0);
    by_one.for_each_row([&](int, Index i, std::span<const double> row) {
      for (std::size_t k = 0; k < row.size(); ++k) {
        const Offset block = of_bonds.pattern.offset[i] + Offset(k / entries);
        const int r = int(k % entries) / d, c = int(k % entries) % d;
        difference = std::max(difference, std::abs(row[k] - of_bonds.entry(block, r, c)));
      }
    });
    EXPECT_LT(difference, 1e-12 * norm(of_bonds.diagonal));

    const Eigen::MatrixXd matrix = full(storing, rest);
    std::vector<double> sums(body.dofs());
    free.absolute_row_sums(sums);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(matrix, Eigen::EigenvaluesOnly);
    EXPECT_LT(spectrum.eigenvalues()[matrix.rows() - 1], std::ranges::max(sums));
  }
}

/// Compressed until bonds turn aside: the exact tangent has negative eigenvalues, the projected
/// none.
TEST_P(StatesOfDimension, FiniteProjectionIsPositive) {
  const int d = GetParam();
  for (const double lambda : {-0.3, 5.0}) {
    Solid solid = finite_solid();
    solid.lambda = solid.lambda_right = lambda;
    BoxSetting box = perturbed_box(d);
    box.extent = d == 2 ? std::array{6, 5, 0} : std::array{4, 4, 3};
    const StateBody body(box, solid);
    Assembler assembler(body.points, body.model, 1);
    std::vector<double> gradient(std::size_t(d * d), 0.0);
    for (int c = 0; c < d; ++c) gradient[std::size_t(c * (d + 1))] = -0.4;
    const std::vector<double> u = body.homogeneous(gradient);
    const auto least = [&](double projection) {
      const Eigen::MatrixXd matrix = full(assembler, u, projection);
      return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
                 .eigenvalues()[0] /
             matrix.norm();
    };
    EXPECT_LT(least(0.0), -1e-3);
    EXPECT_GT(least(1.0), -1e-13);
  }
}

TEST(States, FiniteStatesThatHaveNoLengthAreDegenerate) {
  const StateBody body(tests::small_box(2), finite_solid());
  Assembler assembler(body.points, body.model, 1);
  const std::vector<double> u = body.homogeneous({-1.0, 0.0, 0.0, -1.0});
  std::vector<double> force(body.dofs());
  EXPECT_TRUE(assembler.gradient(u, force).degenerate);
}

TEST_P(StatesOfDimension, TangentIsPositiveAndFreesRigidMotionsAlone) {
  const int d = GetParam();
  BoxSetting box = tests::small_box(d);
  box.extent = d == 2 ? std::array{6, 5, 0} : std::array{4, 4, 3};
  for (const double lambda : {-0.3, 0.1, 0.9, 20.0}) {  // mu = 0.9, lambda + 2 mu / d > 0
    Solid solid;
    solid.lambda = solid.lambda_right = lambda;
    const StateBody body(box, solid);
    Assembler assembler(body.points, body.model, 1);
    const Eigen::MatrixXd matrix = full(assembler, std::vector<double>(body.dofs(), 0.0));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(matrix);
    const Eigen::VectorXd values = spectrum.eigenvalues();
    const int rigid = d == 2 ? 3 : 6;
    EXPECT_GT(values[0], -1e-13 * values[values.size() - 1]);
    EXPECT_LT(std::abs(values[rigid - 1]), 1e-13 * values[values.size() - 1]);
    EXPECT_GT(values[rigid], 1e-4 * values[values.size() - 1]);
    // No eigenvalue is above what the stable step of explicit motions is found with.
    double block = 0.0;
    for (Eigen::Index i = 0; i < matrix.rows(); i += d) {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> own(matrix.block(i, i, d, d));
      block = std::max(block, own.eigenvalues()[d - 1]);
    }
    EXPECT_LT(values[values.size() - 1],
              state_ratios(body.term->shares().constants, d).bound_over_blocks() * block);
  }
}

TEST_P(StatesOfDimension, DilatationOfADilationIsRightAtEveryPoint) {
  const int d = GetParam();
  const double e = 1e-3;
  const Solid solid;
  for (const std::string influence : {"inverse", "constant", "cubic"}) {
    for (const VolumeCorrection correction : {VolumeCorrection::none, VolumeCorrection::linear}) {
      BoxSetting box = perturbed_box(d);
      box.quadrature.volume = correction;
      Solid with = solid;
      with.influence = influence;
      const StateBody body(box, with);
      std::vector<double> gradient(std::size_t(d * d), 0.0);
      for (int c = 0; c < d; ++c) gradient[std::size_t(c * (d + 1))] = e;
      const std::vector<double> u = body.homogeneous(gradient);
      Assembler assembler(body.points, body.model, 1);
      std::vector<double> energies(body.points.volume.size());
      assembler.point_energies(u, energies);
      // theta = d e, and the bonds' part d (d + 2) mu e^2 / 2: d (d lambda + 2 mu) e^2 / 2 in all.
      const double density = 0.5 * d * (d * solid.lambda + 2.0 * solid.mu) * e * e;
      for (std::size_t i = 0; i < energies.size(); ++i) {
        EXPECT_NEAR(energies[i], density * body.points.volume[i],
                    1e-12 * density * body.points.volume[i]);
      }
    }
  }
}

TEST_P(StatesOfDimension, ForcesHaveNoSumAndNoMomentInTheReference) {
  const int d = GetParam();
  const StateBody body(perturbed_box(d), mixed_solid());
  Assembler assembler(body.points, body.model, 1);
  const std::vector<double> u = Random(3).vector(body.dofs(), 0.01);
  std::vector<double> force(body.dofs());
  static_cast<void>(assembler.gradient(u, force));
  double sum[3] = {}, moment = 0.0;
  for (std::size_t i = 0; i < body.points.volume.size(); ++i) {
    const double* f = &force[i * std::size_t(d)];
    const Coordinates at = body.points.position(Index(i));
    for (int c = 0; c < d; ++c) sum[c] += f[c];
    moment += at[0] * f[1] - at[1] * f[0];
  }
  for (const double component : sum) EXPECT_NEAR(component, 0.0, 1e-13 * norm(force));
  EXPECT_NEAR(moment, 0.0, 1e-13 * norm(force));
  EXPECT_TRUE(body.model.balances().force_sum);
  EXPECT_FALSE(body.model.balances().moment_sum);
}

/// lambda = mu: the dilatations drop, and what is left are bonds of the modulus of Poisson's ratio
/// 1/4 (1/3 in plane stress), stretched a little.
TEST_P(StatesOfDimension, IsTheBondModelAtItsPoissonRatio) {
  const int d = GetParam();
  BoxSetting box = tests::small_box(d);
  Solid solid;
  solid.lambda = solid.lambda_right = solid.mu = solid.mu_right = 0.8;
  const StateBody body(box, solid);
  const Model bond_model(bonds_alone(body, solid.mu), Harmonic{1.0});
  Assembler states(body.points, body.model, 1), springs(body.points, bond_model, 1);
  // A small strain everywhere, and disorder that bends bonds less still.
  double last = 0.0;
  for (const double size : {1e-4, 1e-5}) {
    const std::vector<double> u = Random(4).vector(body.dofs(), size * box.spacing);
    std::vector<double> one(body.dofs()), other(body.dofs());
    static_cast<void>(states.gradient(u, one));
    static_cast<void>(springs.gradient(u, other));
    const double error = distance(one, other) / norm(other);
    EXPECT_LT(error, 3.0 * size);
    if (last > 0.0) {
      EXPECT_NEAR(last / error, 10.0, 1.0);  // of first order
    }
    last = error;
  }
}

/// Far from surfaces the collocated operator times the volume is this Hessian, with its shares k.
TEST(States, OfCollocationsSharesAreItsOperatorInsideALattice) {
  BoxSetting box = tests::small_box(2);
  box.extent = {17, 16, 0};
  box.horizon_ratio = 3.0;
  const StateBody body(box, {});
  const Bonds& bonds = body.model.bonds();
  Points ghosted = body.points;
  const double h = box.spacing;
  for (int x = -3; x < box.extent[0] + 3; ++x) {
    for (int y = -3; y < box.extent[1] + 3; ++y) {
      if (x >= 0 && x < box.extent[0] && y >= 0 && y < box.extent[1]) continue;
      ghosted.ghosts.insert(ghosted.ghosts.end(), {(x + 0.5) * h, (y + 0.5) * h});
    }
  }
  auto network = std::make_shared<CollocationNetwork>(
      make_collocation_network(ghosted, bonds, body.setting.horizon, 5, 1).network);
  auto constants = std::make_shared<LameConstants>();
  StateShares shares;
  std::vector<double> kernel(std::size_t(bonds.count()), 0.0);
  const double volume = body.points.volume.front();
  for (std::size_t e = 0; e < network->bond.size(); ++e) {
    kernel[std::size_t(network->bond[e])] = volume * network->kernel_share[e];
  }
  for (Offset bond = 0; bond < bonds.count(); ++bond) {
    shares.whole.push_back(
        {bonds.inverse_length(bond), kernel[std::size_t(bond)] * bonds.length(bond)});
  }
  // m is the integral over the ball, and k has it in: M = V.
  shares.moment.assign(body.points.volume.size(), volume);
  for (Index i = 0; i < body.points.count(); ++i) {
    constants->lambda.push_back(1.7);
    constants->mu.push_back(0.9);
    shares.constants.push_back({1.7, 0.9});
  }
  const Model model(std::shared_ptr<Term>(
      std::make_shared<StateTerm>(std::make_shared<const Bonds>(bonds), Harmonic{1.0},
                                  std::vector<char>(), std::move(shares), StateRules{}, 1)));
  Assembler states(body.points, model, 1);
  CollocationOperator collocation(body.points, {network, constants, TractionForm::full}, 1);
  const std::vector<double> u = Random(5).vector(body.dofs(), 1.0);
  std::vector<double> one(body.dofs()), other(body.dofs());
  states.product(std::vector<double>(body.dofs(), 0.0), u, one, 0.0);
  collocation.forces(u, {}, other);
  int inside = 0;
  for (Index i = 0; i < body.points.count(); ++i) {
    if (!tests::is_inside(body.points, i, box, 6.5 * h)) continue;
    ++inside;
    for (std::size_t c = 0; c < 2; ++c) {
      const std::size_t k = std::size_t(i) * 2 + c;
      EXPECT_NEAR(one[k], other[k], 1e-12 * largest(one));
    }
  }
  EXPECT_GE(inside, 12);
}

/// In the bulk of a fine neighbourhood the stress of a homogeneous strain is Hooke's.
TEST(States, StressOfAHomogeneousStrainIsHookes) {
  BoxSetting box = tests::small_box(2);
  box.extent = {21, 21, 0};
  box.horizon_ratio = 5.015;
  box.quadrature.volume = VolumeCorrection::linear;
  const Solid solid;
  const StateBody body(box, solid);
  Assembler assembler(body.points, body.model, 1);
  const std::vector<double> h{1e-3, 4e-4, -2e-4, 5e-4};
  std::vector<double> virials(body.points.volume.size() * 4);
  assembler.virials(body.homogeneous(h), virials);
  const double trace = h[0] + h[3];
  const std::vector<double> stress{solid.lambda * trace + 2.0 * solid.mu * h[0],
                                   solid.mu * (h[1] + h[2]), solid.mu * (h[1] + h[2]),
                                   solid.lambda * trace + 2.0 * solid.mu * h[3]};
  int inside = 0;
  for (Index i = 0; i < body.points.count(); ++i) {
    if (!tests::is_inside(body.points, i, box, 5.6 * box.spacing)) continue;
    ++inside;
    for (std::size_t c = 0; c < 4; ++c) {
      // The mean over a lattice's bonds of n n n n is not quite that of all directions.
      EXPECT_NEAR(virials[std::size_t(i) * 4 + c] / body.points.volume[i], stress[c],
                  0.005 * stress[0]);
    }
  }
  EXPECT_GE(inside, 81);
}

/// Virials are the derivative of the point's energy by a gradient that its neighbourhood has.
TEST(States, VirialsAreTheDerivativeOfPointEnergies) {
  const StateBody body(perturbed_box(3), mixed_solid());
  Assembler assembler(body.points, body.model, 1);
  const std::vector<double> at = Random(6).vector(9, 1e-3), rate = Random(7).vector(9, 1e-3);
  std::vector<double> virials(body.points.volume.size() * 9);
  assembler.virials(body.homogeneous(at), virials);
  std::vector<double> expected;
  for (std::size_t i = 0; i < body.points.volume.size(); ++i) {
    double sum = 0.0;
    for (std::size_t c = 0; c < 9; ++c) sum += virials[i * 9 + c] * rate[c];
    expected.push_back(sum);
  }
  EXPECT_TRUE(tests::is_derivative(
      [&](double t) {
        std::vector<double> h = at;
        for (std::size_t c = 0; c < 9; ++c) h[c] += t * rate[c];
        std::vector<double> energies(body.points.volume.size());
        assembler.point_energies(body.homogeneous(h), energies);
        return energies;
      },
      expected, 1.0));
}

TEST(States, HaveTheSameBitsOnAnyNumberOfThreads) {
  BoxSetting box = perturbed_box(3);
  box.extent = {40, 4, 4};
  std::vector<double> forces, blocks;
  double energy = 0.0;
  for (const int threads : {1, 2, 3}) {
    const StateBody body(box, mixed_solid(), threads);
    Assembler assembler(body.points, body.model, threads);
    const std::vector<double> u = Random(8).vector(body.dofs(), 0.01);
    std::vector<double> force(body.dofs());
    const double found = assembler.gradient(u, force).energy;
    Tangent tangent(assembler);
    assembler.tangent(u, tangent, 0.0);
    if (threads > 1) {
      ASSERT_LE(threads, int(assembler.parts().size()));
      EXPECT_EQ(found, energy);
      EXPECT_EQ(force, forces);
      EXPECT_EQ(tangent.off_diagonal, blocks);
    }
    energy = found;
    forces = force;
    blocks = tangent.off_diagonal;
  }
}

TEST(States, WithoutDilatationsCoupleBondsAlone) {
  Solid solid;
  solid.lambda = solid.lambda_right = solid.mu = solid.mu_right = 1.0;
  const StateBody alike(tests::small_box(2), solid), other(tests::small_box(2), {});
  EXPECT_EQ(alike.model.pattern().blocks(), alike.model.bonds().count());
  EXPECT_GT(other.model.pattern().blocks(), 2 * other.model.bonds().count());
}

// ---- Damage

/// What breaks takes its part out of the energy: the same as if it had been cut from the start.
TEST(States, WithBrokenBondsAreThoseOfACutBody) {
  const BoxSetting box = perturbed_box(2);
  Solid solid = mixed_solid();
  solid.critical = 0.01;
  const StateBody body(box, solid);
  Assembler assembler(body.points, body.model, 1);
  const double middle = 0.5 * box.extent[0] * box.spacing;
  std::vector<double> stretches(std::size_t(body.model.bonds().count()), 0.0);
  tests::for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset bond) {
    const bool crosses =
        (body.points.position(i)[0] < middle) != (body.points.position(j)[0] < middle);
    const bool is_low = body.points.position(i)[1] < 0.4;
    if (crosses && is_low) stretches[std::size_t(bond)] = 0.02;
  });
  const History history = assembler.history_of(stretches);

  Bonds left = body.model.bonds();
  StateShares shares = body.term->shares();
  BondKinds left_shares;
  left.remove_if([&](Index, Offset bond) { return stretches[std::size_t(bond)] > 0.0; });
  for (std::size_t b = 0; b < stretches.size(); ++b) {
    if (stretches[b] == 0.0) left_shares.push_back(shares.whole[Offset(b)]);
  }
  ASSERT_LT(left_shares.size(), stretches.size());
  shares.whole = std::move(left_shares);
  const Model cut(std::shared_ptr<Term>(
      std::make_shared<StateTerm>(std::make_shared<const Bonds>(std::move(left)), Harmonic{1.0},
                                  std::vector<char>(), std::move(shares), StateRules{}, 1)));
  Assembler of_cut(body.points, cut, 1);
  const std::vector<double> u = Random(9).vector(body.dofs(), 0.01);
  std::vector<double> one(body.dofs()), other(body.dofs());
  const double energy = assembler.gradient({u, history}, one).energy;
  EXPECT_NEAR(energy, of_cut.gradient(u, other).energy, 1e-13 * energy);
  EXPECT_LT(distance(one, other), 1e-13 * norm(one));
  const Eigen::MatrixXd damaged = full(assembler, {u, history}), whole = full(of_cut, u);
  EXPECT_LT((damaged - whole).norm(), 1e-13 * whole.norm());
  EXPECT_LT(energy, assembler.energy({u, assembler.initial_history()}).energy);
}

TEST(States, ThatCommitDissipateWhatTheyLose) {
  const BoxSetting box = tests::small_box(2);
  Solid solid;
  solid.critical = 0.01;
  const StateBody body(box, solid);
  Assembler assembler(body.points, body.model, 1);
  History history = assembler.initial_history();
  // A gap of a tenth of a spacing in the middle: 5 % of the bonds across.
  std::vector<double> u(body.dofs(), 0.0);
  const double middle = 0.5 * box.extent[0] * box.spacing;
  for (Index i = 0; i < body.points.count(); ++i) {
    if (body.points.position(i)[0] > middle) u[std::size_t(i) * 2] = 0.1 * box.spacing;
  }
  const double before = assembler.energy({u, history}).energy;
  const DamageGrowth would = assembler.growth({u, history});
  ASSERT_GT(would.breaking, 0);
  std::vector<double> gradient(body.dofs());
  const Evaluation committed = assembler.commit(u, history, gradient);
  EXPECT_EQ(committed.growth.breaking, would.breaking);
  EXPECT_TRUE(committed.moves_equilibrium);
  // All bonds across are stretched far beyond what they bear.
  // With the modulus 1: w L s_c^2 / 2 of each bond by its law.
  double by_law = 0.0;
  tests::for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset bond) {
    if ((u[std::size_t(i) * 2] != 0.0) == (u[std::size_t(j) * 2] != 0.0)) return;
    const double length = body.model.bonds().length(bond);
    const double dx =
        std::abs(body.points.position(i)[0] - body.points.position(j)[0]) + 0.1 * box.spacing;
    const double dy = body.points.position(i)[1] - body.points.position(j)[1];
    if (std::hypot(dx, dy) / length - 1.0 > solid.critical) {
      by_law += 0.5 * body.model.bonds().weight(bond) * length * solid.critical * solid.critical;
    }
  });
  EXPECT_GT(committed.released + by_law, 0.0);
  EXPECT_LT(committed.released + by_law, before - committed.energy);
  EXPECT_LT(committed.energy, before);
  // Once is enough.
  EXPECT_EQ(assembler.growth({u, history}).degrading, 0);
  const Evaluation again = assembler.commit(u, history, gradient);
  EXPECT_FALSE(again.moves_equilibrium);
  EXPECT_EQ(again.released, 0.0);
  EXPECT_EQ(again.energy, committed.energy);
}

/// What a bond held when it passed its strength is dissipated; what it was stretched beyond is not.
TEST(States, DissipateWhatBondsHeldAtTheirStrength) {
  const BoxSetting box = tests::small_box(2);
  Solid solid = mixed_solid();
  solid.critical = 0.01;
  const StateBody body(box, solid);
  Assembler assembler(body.points, body.model, 1);
  const auto dissipated = [&](double times, double critical_share) {
    // In a dilation all bonds have one stretch, and break together.
    const double e = times * solid.critical;
    const std::vector<double> u = body.homogeneous({e, 0.0, 0.0, e});
    History history = assembler.initial_history();
    const double before = assembler.energy({u, history}).energy;
    std::vector<double> gradient(body.dofs());
    const Evaluation committed = assembler.commit(u, history, gradient);
    EXPECT_EQ(committed.growth.breaking, body.model.bonds().count());
    EXPECT_EQ(committed.energy, 0.0);
    EXPECT_EQ(tests::largest(gradient), 0.0);
    double by_law = 0.0;
    tests::for_each_bond(body.model.bonds(), [&](Index, Index, Offset bond) {
      by_law += 0.5 * body.model.bonds().weight(bond) * body.model.bonds().length(bond) *
                solid.critical * solid.critical;
    });
    EXPECT_NEAR(committed.released + by_law, critical_share * before, 1e-9 * before);
  };
  dissipated(1.0 + 1e-12, 1.0);
  dissipated(1.25, 0.64);
}

/// A plane tear under a uniform dilation takes what crack_energy_of_dilation tells, with any
/// kernel; exactly where lambda = mu, for then the dilatations, which a tear takes twice over,
/// drop.
TEST(States, TornByAPlaneLoseTheCrackEnergy) {
  const double e = 1e-3;
  for (const std::string influence : {"inverse", "constant", "quintic"}) {
    BoxSetting box = tests::small_box(2);
    box.extent = {41, 41, 0};
    box.horizon_ratio = 8.015;
    box.quadrature.volume = VolumeCorrection::linear;
    Solid solid;
    solid.lambda = solid.lambda_right = solid.mu = solid.mu_right = 0.8;
    solid.influence = influence;
    solid.critical = 0.5;
    const StateBody body(box, solid);
    Assembler assembler(body.points, body.model, 1);
    const std::vector<double> u = body.homogeneous({e, 0.0, 0.0, e});
    const History whole = assembler.initial_history();
    const double middle = 21.0 * box.spacing, margin = 8.6 * box.spacing;
    std::vector<double> stretches(std::size_t(body.model.bonds().count()), 0.0);
    tests::for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset bond) {
      const bool crosses =
          (body.points.position(i)[0] < middle) != (body.points.position(j)[0] < middle);
      if (crosses) stretches[std::size_t(bond)] = 1.0;
    });
    std::vector<double> before(body.points.volume.size()), after(before);
    assembler.point_energies({u, whole}, before);
    assembler.point_energies({u, assembler.history_of(stretches)}, after);
    double lost = 0.0, rows = 0.0;
    for (Index i = 0; i < body.points.count(); ++i) {
      const Coordinates at = body.points.position(i);
      if (at[1] < margin || at[1] > 41.0 * box.spacing - margin) continue;
      lost += before[std::size_t(i)] - after[std::size_t(i)];
      if (at[0] < box.spacing) rows += 1.0;
    }
    const double area = rows * box.spacing * box.cross_section;
    const double expected = crack_energy_of_dilation(LamePair{0.8, 0.8}, body.setting) * e * e;
    EXPECT_NEAR(lost / area, expected, 0.02 * expected) << influence;
  }
}

}  // namespace
}  // namespace peristat
