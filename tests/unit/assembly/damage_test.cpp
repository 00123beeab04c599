#include "assembly/terms/damage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "tests/bodies.hpp"
#include "tests/finite_differences.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::distance;
using tests::dot;
using tests::norm;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// ---- One bond

/// Two points on a line, joined by one bond of length 0.4 and weight 0.7.
struct OneBond {
  static constexpr double length = 0.4, weight = 0.7;
  Points points;
  Model model;

  explicit OneBond(const BondPotential& potential) {
    points.dimension = 1;
    points.spacing = length;
    points.reference = {0.1, 0.1 + length};
    points.volume = {1.0, 1.0};
    Bonds bonds = tests::bonds_between({0, 1, 1}, {1});
    bonds.kind.push_back({1.0 / length, weight});
    model = Model(std::move(bonds), potential);
  }
  [[nodiscard]] static std::vector<double> stretched(double s) { return {0.0, s * length}; }
};

constexpr double modulus = 2.5e3, onset = 0.016, critical = 0.02, rate = 3.0;

/// T of eq. 12 of [ADAPT], as published, and that of eq. 9 of [GPMB].
double tanh_integrity(double s) {
  if (s <= onset) return 1.0;
  if (s >= critical) return 0.0;
  return 0.5 * (1.0 - std::tanh(rate * (onset + critical - 2.0 * s) / (onset - critical)));
}
double brittle_integrity(double s) { return s < critical ? 1.0 : 0.0; }

/// int_0^s r T(r) dr: exact where T is 1, Simpson's rule in between.
template <class T>
double moment(const T& integrity, double s) {
  const double elastic = std::min(s, onset), end = std::min(s, critical);
  double sum = 0.5 * elastic * elastic;
  if (end <= onset) return sum;
  const int cells = 2000;
  const double h = (end - onset) / cells;
  // Just inside of the jumps of T at both ends.
  const auto f = [&](double r) {
    const double inside = std::clamp(r, onset * (1.0 + 1e-15), critical * (1.0 - 1e-15));
    return r * integrity(inside);
  };
  for (int k = 0; k < cells; ++k) {
    const double a = onset + k * h;
    sum += h / 6.0 * (f(a) + 4.0 * f(a + 0.5 * h) + f(a + h));
  }
  return sum;
}

/// Pulls, unloads, presses, reloads and breaks the bond; every state is accepted.
template <class T>
void follow_one_bond(const BondPotential& potential, const T& integrity, int damaging) {
  OneBond bond(potential);
  Assembler assembler(bond.points, bond.model, 1);
  History history = assembler.initial_history();
  const double factor = OneBond::weight * OneBond::length * modulus;
  double kappa = 0.0, dissipated_before = 0.0;
  int degraded = 0, broken = 0;
  ASSERT_EQ(bond_stretches(bond.model, history).size(), 1u);
  for (const double s : {0.01, 0.0165, 0.0180, 0.006, 0.0, -0.03, 0.0180, 0.0179, 0.0183, 0.0195,
                         0.001, 0.03, 0.01, -0.01, 0.05}) {
    SCOPED_TRACE(s);
    const std::vector<double> state = OneBond::stretched(s);
    const bool grows = integrity(s) < integrity(kappa);
    const double after = grows ? s : kappa;
    // The force before and after the state is committed is the same: c T(max(s, kappa)) s.
    const double force = OneBond::weight * modulus * integrity(std::max(s, kappa)) * s;
    const double stored = 0.5 * factor * integrity(after) * s * s;
    const double dissipated =
        factor * (moment(integrity, after) - 0.5 * integrity(after) * after * after);

    std::vector<double> gradient(2), committed(2);
    const double taken_up = assembler.gradient({state, history}, gradient).energy;
    const DamageGrowth would = assembler.growth({state, history});
    const Evaluation result = assembler.commit(state, history, committed);
    // The stretch is a difference of numbers of size one: 1e-16 over 0.01.
    const double tolerance = 1e-12 * OneBond::weight * modulus * critical;
    EXPECT_NEAR(gradient[1], force, tolerance);
    EXPECT_NEAR(gradient[0], -force, tolerance);
    EXPECT_NEAR(committed[1], force, tolerance);
    EXPECT_NEAR(committed[0], -force, tolerance);
    // Simpson's rule with 2000 cells over a function that bends on a fifth of the way: 1e-13.
    EXPECT_NEAR(result.energy, stored, 1e-12 * factor * critical * critical);
    EXPECT_NEAR(taken_up, stored + dissipated - dissipated_before,
                1e-11 * factor * critical * critical);
    std::vector<double> damage(2);
    const DamageState state_of_damage = assess_damage(bond.model, history, {}, damage);
    EXPECT_NEAR(state_of_damage.dissipated_energy, dissipated,
                1e-11 * factor * critical * critical);
    for (const double phi : damage) EXPECT_NEAR(phi, 1.0 - integrity(after), 1e-11);
    EXPECT_EQ(state_of_damage.broken_bonds, after >= critical);
    EXPECT_EQ(broken_bonds(bond.model, history), std::vector<char>{char(after >= critical)});
    EXPECT_EQ(would.degrading, grows);
    EXPECT_EQ(result.growth.degrading, grows);
    EXPECT_EQ(result.growth.breaking, grows && s >= critical);
    EXPECT_EQ(would.breaking, result.growth.breaking);
    EXPECT_NEAR(bond_stretches(bond.model, history)[0], after, 1e-15);
    degraded += grows;
    broken += result.growth.breaking;
    kappa = after;
    dissipated_before = dissipated;
  }
  EXPECT_EQ(degraded, damaging);
  EXPECT_EQ(broken, 1);
}

TEST(DamageOfOneBond, FollowsTheClosedFormOfAPublishedTanhLaw) {
  follow_one_bond(Degraded<TanhDegradation>{modulus, {onset, critical, rate}}, tanh_integrity, 5);
}

TEST(DamageOfOneBond, FollowsTheClosedFormOfABrittleLaw) {
  follow_one_bond(Degraded<CriticalStretch>{modulus, {critical}}, brittle_integrity, 1);
}

// ---- Bodies

constexpr double wide_onset = 0.05, wide_critical = 0.6;

/// Bonds that soften over stretches which random states reach in part, without jumps.
BondPotential softening(double micromodulus) {
  return Degraded<TanhDegradation>{micromodulus,
                                   TanhDegradation::continuous(wide_onset, wide_critical, rate)};
}

/// T of the continuous form, written down again.
double softened(double s) {
  const auto published = [](double r) {
    return 1.0 / (1.0 + std::exp(2.0 * rate * (2.0 * r - wide_onset - wide_critical) /
                                 (wide_critical - wide_onset)));
  };
  if (s <= wide_onset) return 1.0;
  if (s >= wide_critical) return 0.0;
  return (published(s) - published(wide_critical)) /
         (published(wide_onset) - published(wide_critical));
}

tests::BoxSetting softening_box(int dimension) {
  tests::BoxSetting box = tests::small_box(dimension);
  if (dimension == 2) box.extent = {6, 5, 0};
  if (dimension == 3) box.extent = {4, 3, 3};
  box.perturbation = 0.2;
  box.potential = softening;
  return box;
}

/// A state that damages some bonds and breaks others: random, and the last point torn off.
std::vector<double> damaging_state(const BoxBody& body) {
  std::vector<double> state = body.random_state(11);
  const int d = body.points.dimension;
  for (int c = 0; c < d; ++c) state[state.size() - std::size_t(d) + c] += 0.9 * body.points.spacing;
  return state;
}

/// Another one: random and pulled.
std::vector<double> pulled_state(const BoxBody& body, std::uint64_t seed, double strain = 0.08) {
  std::vector<double> state = body.random_state(seed);
  for (std::size_t k = 0; k < state.size(); ++k) state[k] += strain * body.points.reference[k];
  return state;
}

std::vector<double> moved(const std::vector<double>& from, double t,
                          const std::vector<double>& along) {
  std::vector<double> result = from;
  for (std::size_t k = 0; k < result.size(); ++k) result[k] += t * along[k];
  return result;
}

std::vector<double> stretches(const BoxBody& body, const std::vector<double>& state) {
  const int d = body.points.dimension;
  std::vector<double> result;
  tests::for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset) {
    double squared = 0.0;
    for (int c = 0; c < d; ++c) {
      const double along = body.points.position(j)[c] - body.points.position(i)[c] +
                           state[std::size_t(j) * d + c] - state[std::size_t(i) * d + c];
      squared += along * along;
    }
    result.push_back(std::sqrt(squared) / tests::reference_distance(body.points, i, j) - 1.0);
  });
  return result;
}

/// Which branch of the law each bond is on: 0 unloading, 1 loading, 2 breaking, 3 broken.
std::vector<int> branches(const BoxBody& body, std::span<const double> history,
                          const std::vector<double>& state) {
  const std::vector<double> s = stretches(body, state);
  std::vector<int> result(s.size(), 0);
  for (std::size_t b = 0; b < s.size(); ++b) {
    if (history[b] >= wide_critical) {
      result[b] = 3;
    } else if (s[b] > std::max(history[b], wide_onset)) {
      result[b] = s[b] < wide_critical ? 1 : 2;
    }
  }
  return result;
}

/// A body with damage, and a state and a direction in which no bond changes its branch within a
/// step.
struct DamagedBody {
  static constexpr double step = 1e-4;  // a thousandth of the stretches on which the law bends
  BoxBody body;
  Assembler assembler;
  History history;
  std::vector<double> state, along;

  explicit DamagedBody(const tests::BoxSetting& box, int threads = 2)
      : body(box),
        assembler(body.points, body.model, threads),
        history(assembler.initial_history()) {
    (void)assembler.commit(damaging_state(body), history);
    for (std::uint64_t seed = 100; seed < 1100; ++seed) {
      state = pulled_state(body, seed);
      along = tests::Random(seed + 10000).vector(body.dofs(), body.points.spacing);
      const auto at = [&](double t) {
        return branches(body, bond_stretches(body.model, history), moved(state, t, along));
      };
      const std::vector<int> here = at(0.0);
      if (at(step) != here || at(-step) != here) continue;
      // Bonds on every branch, of those that unload some with and some without damage.
      int unloads_damaged = 0;
      for (std::size_t b = 0; b < here.size(); ++b) {
        unloads_damaged += here[b] == 0 && bond_stretches(body.model, history)[b] > wide_onset;
      }
      const auto some = [&](int branch) { return std::count(here.begin(), here.end(), branch); };
      found = some(0) > unloads_damaged && unloads_damaged > 0 && some(1) > 0 && some(3) > 0;
      if (found) return;
    }
  }
  bool found = false;
};

/// Bodies of bonds in every dimension, and with triangles and tetrahedra.
std::vector<tests::BoxSetting> softening_boxes() {
  std::vector<tests::BoxSetting> boxes;
  for (int dimension = 1; dimension <= 3; ++dimension) boxes.push_back(softening_box(dimension));
  for (const bool stored : {false, true}) {
    boxes.push_back(softening_box(2));
    boxes.back().triangles = 1.0;
    boxes.back().stored = stored;
    boxes.push_back(softening_box(3));
    boxes.back().triangles = 0.5;
    boxes.back().tetrahedra = 0.5;
    boxes.back().stored = stored;
  }
  return boxes;
}

std::string told(const tests::BoxSetting& box) {
  return std::to_string(box.dimension) + "D" + (box.triangles > 0.0 ? " with triangles" : "") +
         (box.tetrahedra > 0.0 ? " and tetrahedra" : "") + (box.stored ? ", stored" : "");
}

TEST(Damage, GradientIsDerivativeOfEnergyOnEveryBranch) {
  for (const auto& box : softening_boxes()) {
    SCOPED_TRACE(told(box));
    DamagedBody damaged(box);
    ASSERT_TRUE(damaged.found);
    std::vector<double> gradient(damaged.body.dofs());
    ASSERT_FALSE(damaged.assembler.gradient({damaged.state, damaged.history}, gradient).degenerate);
    const auto energy = [&](double t) {
      return std::vector<double>{
          damaged.assembler.energy({moved(damaged.state, t, damaged.along), damaged.history})
              .energy};
    };
    EXPECT_TRUE(tests::is_derivative(energy, {dot(gradient, damaged.along)}, DamagedBody::step));
  }
}

TEST(Damage, TangentAndProductAreTheDerivativeOfTheGradientOnEveryBranch) {
  for (const auto& box : softening_boxes()) {
    SCOPED_TRACE(told(box));
    DamagedBody damaged(box);
    ASSERT_TRUE(damaged.found);
    const std::size_t dofs = damaged.body.dofs();
    Tangent tangent(BlockPattern(damaged.body.model.bonds()), box.dimension);
    damaged.assembler.tangent({damaged.state, damaged.history}, tangent);
    std::vector<double> column(dofs), product(dofs);
    tangent.multiply(damaged.along, column);
    damaged.assembler.product({damaged.state, damaged.history}, damaged.along, product);
    const auto gradient = [&](double t) {
      std::vector<double> result(dofs);
      (void)damaged.assembler.gradient({moved(damaged.state, t, damaged.along), damaged.history},
                                       result);
      return result;
    };
    EXPECT_TRUE(tests::is_derivative(gradient, column, DamagedBody::step));
    // Sums of some ten terms that cancel in part.
    EXPECT_LE(distance(column, product), 1e-13 * tangent.frobenius_norm() * norm(damaged.along));
    ASSERT_GT(norm(product),
              1e-3 * tangent.frobenius_norm() * norm(damaged.along) / std::sqrt(double(dofs)));
  }
}

TEST(Damage, ProjectedTangentIsPositiveSemidefinite) {
  for (const auto& box : softening_boxes()) {
    SCOPED_TRACE(told(box));
    DamagedBody damaged(box);
    // Most bonds are stretched past the peak of s T(s).
    const std::vector<double> far = pulled_state(damaged.body, 7, 0.35);
    const auto dofs = Eigen::Index(damaged.body.dofs());
    const auto least_over_largest = [&](double projection) {
      Tangent tangent(BlockPattern(damaged.body.model.bonds()), box.dimension);
      damaged.assembler.tangent({far, damaged.history}, tangent, projection);
      Eigen::MatrixXd matrix(dofs, dofs);
      std::vector<double> unit(damaged.body.dofs(), 0.0), column(damaged.body.dofs());
      for (Eigen::Index k = 0; k < dofs; ++k) {
        unit[std::size_t(k)] = 1.0;
        tangent.multiply(unit, column);
        unit[std::size_t(k)] = 0.0;
        matrix.col(k) = Eigen::Map<const Eigen::VectorXd>(column.data(), dofs);
      }
      const Eigen::VectorXd eigenvalues =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
              .eigenvalues();
      return eigenvalues.minCoeff() / eigenvalues.maxCoeff();
    };
    EXPECT_LT(least_over_largest(0.0), -1e-3);  // bonds soften
    // Round-off of the eigenvalues, some hundred epsilons.
    EXPECT_GT(least_over_largest(1.0), -1e-13);
  }
}

TEST(Damage, TrialStatesLeaveTheHistoryAlone) {
  for (const auto& box : softening_boxes()) {
    SCOPED_TRACE(told(box));
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    History history = assembler.initial_history();
    std::vector<double> before(body.dofs()), trial(body.dofs()), after(body.dofs());
    (void)assembler.commit(damaging_state(body), history);
    const History kept = history;
    const auto kappas = [&](const History& of) {
      const std::span<const double> stretches = bond_stretches(body.model, of);
      return std::vector<double>(stretches.begin(), stretches.end());
    };
    const std::vector<double> told = kappas(history);
    const std::vector<double> looked_at = pulled_state(body, 5, 0.0);
    const double energy = assembler.gradient({looked_at, history}, before).energy;

    // Every call but commit, far beyond the histories.
    const std::vector<double> far = pulled_state(body, 6, 0.8);
    ASSERT_GT(assembler.growth({far, history}).breaking, 10);
    Tangent tangent(BlockPattern(body.model.bonds()), box.dimension);
    (void)assembler.energy({far, history});
    (void)assembler.gradient({far, history}, trial);
    assembler.tangent({far, history}, tangent);
    assembler.tangent({far, history}, tangent, 1.0);
    assembler.product({far, history}, trial, after);
    std::vector<double> of_points(body.points.volume.size());
    (void)assembler.point_energies({far, history}, of_points);
    EXPECT_EQ(kappas(history), told);
    EXPECT_EQ(assembler.gradient({looked_at, history}, after).energy, energy);
    EXPECT_EQ(after, before);

    // A commit moves it, and no copy of it, triangles and tetrahedra included.
    (void)assembler.commit(far, history);
    EXPECT_NE(kappas(history), told);
    EXPECT_EQ(kappas(kept), told);
    (void)assembler.gradient({looked_at, history}, after);
    EXPECT_GT(distance(after, before), 0.1 * norm(before));
    for (const History& again : {kept, assembler.history_of(told)}) {
      EXPECT_EQ(assembler.gradient({looked_at, again}, after).energy, energy);
      EXPECT_EQ(after, before);
    }
  }
}

TEST(Damage, GrowthIsWhatACommitThenChanges) {
  for (const auto& box : softening_boxes()) {
    SCOPED_TRACE(told(box));
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    History history = assembler.initial_history();
    int grew = 0, rested = 0, broke = 0;
    for (const double strain : {-0.3, -0.15, 0.0, -0.1, 0.1, 0.05, 0.3, 0.2, 0.45, 0.8, 0.3}) {
      const std::vector<double> state = pulled_state(body, 20, strain);
      const std::vector<double> s = stretches(body, state);
      const std::span<const double> kappas = bond_stretches(body.model, history);
      const std::vector<double> before(kappas.begin(), kappas.end());
      const DamageGrowth growth = assembler.growth({state, history});
      const DamageGrowth committed = assembler.commit(state, history).growth;
      Index degrading = 0, breaking = 0;
      double utilisation = 0.0;
      for (std::size_t b = 0; b < s.size(); ++b) {
        const double now = bond_stretches(body.model, history)[b];
        degrading += now != before[b];
        breaking += now >= wide_critical && before[b] < wide_critical;
        if (now != before[b]) {
          EXPECT_GT(now, before[b]);
          EXPECT_GT(now, wide_onset);
          EXPECT_NEAR(now, s[b], 16 * epsilon);  // another order of the same few operations
        }
        if (before[b] >= wide_critical) continue;
        utilisation = std::max(utilisation, s[b] / std::max(before[b], wide_onset));
      }
      EXPECT_EQ(growth.degrading, degrading);
      EXPECT_EQ(growth.breaking, breaking);
      EXPECT_EQ(committed.degrading, degrading);
      EXPECT_EQ(committed.breaking, breaking);
      EXPECT_NEAR(growth.utilisation, utilisation, 1e-13 * std::max(utilisation, 1.0));
      EXPECT_EQ(growth.utilisation > 1.0, growth.degrading > 0);
      // Once committed, the state damages nothing more.
      const DamageGrowth again = assembler.growth({state, history});
      EXPECT_EQ(again.degrading, 0);
      EXPECT_LE(again.utilisation, 1.0);
      (degrading > 0 ? grew : rested) += 1;
      broke += breaking > 0;
    }
    EXPECT_GE(grew, 3);
    EXPECT_GE(rested, 3);
    EXPECT_GE(broke, 2);
  }
}

TEST(Damage, BondsThatNeverFailStayHarmonic) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    tests::BoxSetting box = softening_box(dimension);
    BoxBody body(box);
    box.potential = {};
    const BoxBody elastic(box);
    const std::vector<double> far = pulled_state(body, 6, 0.8);
    std::vector<double> expected(body.dofs()), gradient(body.dofs());
    Assembler harmonic(elastic.points, elastic.model, 1);
    History nothing = harmonic.initial_history();
    EXPECT_TRUE(bond_stretches(elastic.model, nothing).empty());
    EXPECT_EQ(harmonic.commit(far, nothing, expected).growth.degrading, 0);

    // All of them: the body is harmonic.
    std::vector<char> never_fails(std::size_t(body.model.bonds().count()), 1);
    body.replace_bonds(body.model.bonds(), never_fails);
    {
      Assembler assembler(body.points, body.model, 1);
      History history = assembler.initial_history();
      EXPECT_EQ(assembler.growth({far, history}).degrading, 0);
      EXPECT_EQ(assembler.growth({far, history}).utilisation, 0.0);
      const Evaluation found = assembler.commit(far, history, gradient);
      EXPECT_EQ(found.growth.degrading, 0);
      EXPECT_NEAR(found.energy / harmonic.energy(far).energy, 1.0, 1e-14);
      EXPECT_LE(distance(gradient, expected), 1e-14 * norm(expected));
      std::vector<double> damage(body.points.volume.size());
      const DamageState state = assess_damage(body.model, history, {}, damage);
      EXPECT_EQ(state.dissipated_energy, 0.0);
      EXPECT_EQ(state.max_damage, 0.0);
    }

    // Every other one: just these have no history of damage, whatever is committed.
    for (std::size_t b = 0; b < never_fails.size(); b += 2) never_fails[b] = 0;
    body.replace_bonds(body.model.bonds(), never_fails);
    Assembler assembler(body.points, body.model, 1);
    History history = assembler.initial_history();
    const std::vector<double> s = stretches(body, far);
    (void)assembler.commit(far, history);
    double energy = 0.0;
    Index damaged = 0;
    for (Index i = 0, b = 0; i < body.points.count(); ++i) {
      for (; b < body.model.bonds().offset[i + 1]; ++b) {
        const bool never = never_fails[b] != 0;
        const double kappa = bond_stretches(body.model, history)[b];
        EXPECT_EQ(kappa, never ? Degraded<TanhDegradation>::never_fails : kappa);
        damaged += !never && kappa > wide_onset;
        const double integrity = never ? 1.0 : softened(std::max(s[b], 0.0));
        energy += 0.5 * micromodulus(box.youngs_modulus, body.setting) * integrity * s[b] * s[b] *
                  body.model.bonds().weight(b) * body.model.bonds().length(b);
      }
    }
    EXPECT_GT(damaged, 3);
    EXPECT_NEAR(assembler.energy({far, history}).energy / energy, 1.0, 1e-12);
  }
}

TEST(Damage, HeldDamageLetsBondsFollowTheirSecants) {
  for (const auto& box : softening_boxes()) {
    SCOPED_TRACE(told(box));
    DamagedBody damaged(box);
    Assembler& assembler = damaged.assembler;
    const History& history = damaged.history;
    const std::vector<double>& state = damaged.state;
    const std::vector<double> s = stretches(damaged.body, state);
    const Bonds& bonds = damaged.body.model.bonds();
    const double c = micromodulus(box.youngs_modulus, damaged.body.setting);
    double secants = 0.0, taken_up = 0.0;
    const double free = assembler.energy({state, history}).energy;
    const double held = assembler.energy({state, history, Damage::held}).energy;
    EXPECT_EQ(assembler.energy({state, history}).energy, free);
    const auto potential = std::get<Degraded<TanhDegradation>>(damaged.body.potential());
    for (std::size_t b = 0; b < s.size(); ++b) {
      const double scale = bonds.weight(b) * bonds.length(Offset(b));
      const double kappa = bond_stretches(damaged.body.model, history)[b];
      secants += scale * 0.5 * c * softened(kappa) * s[b] * s[b];
      taken_up += scale * potential(s[b], kappa).value;
    }
    ASSERT_GT(std::abs(secants - taken_up), 1e-3 * taken_up);
    EXPECT_NEAR((held - free) / (secants - taken_up), 1.0, 1e-10);
  }
}

TEST(Damage, IsTheShareOfTheWeightThatIsLost) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const BoxBody body(softening_box(dimension));
    Assembler assembler(body.points, body.model, 2);
    History history = assembler.initial_history();
    (void)assembler.commit(damaging_state(body), history);
    const std::span<const double> kappas = bond_stretches(body.model, history);
    const auto n = std::size_t(body.points.count());
    std::vector<double> cut = tests::Random(3).vector(n, body.model.bonds().weight(0));
    for (double& weight : cut) weight = std::max(weight, 0.0);  // nothing is cut at some
    const auto potential = std::get<Degraded<TanhDegradation>>(body.potential());

    for (const bool with_cut : {false, true}) {
      // Point by point, over all bonds.
      std::vector<double> expected(n), damage(n, 1e300);
      Index broken = 0;
      double dissipated = 0.0;
      for (std::size_t p = 0; p < n; ++p) {
        double whole = with_cut ? cut[p] : 0.0, left = 0.0;
        tests::for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset b) {
          if (std::size_t(i) != p && std::size_t(j) != p) return;
          const double weight = body.model.bonds().weight(b);
          whole += weight;
          left += weight * softened(kappas[b]);
        });
        expected[p] = 1.0 - left / whole;
      }
      tests::for_each_bond(body.model.bonds(), [&](Index, Index, Offset b) {
        broken += kappas[b] >= wide_critical;
        dissipated += body.model.bonds().weight(b) * body.model.bonds().length(b) *
                      potential.dissipated(kappas[b]);
      });
      const DamageState state =
          assess_damage(body.model, history, with_cut ? cut : std::vector<double>{}, damage);
      ASSERT_GT(broken, 0);
      ASSERT_GT(dissipated, 0.0);
      EXPECT_EQ(state.broken_bonds, broken);
      EXPECT_NEAR(state.dissipated_energy / dissipated, 1.0, 1e-13);
      for (std::size_t p = 0; p < n; ++p) EXPECT_NEAR(damage[p], expected[p], 1e-13);
      EXPECT_EQ(state.max_damage, *std::max_element(damage.begin(), damage.end()));
      EXPECT_GT(state.max_damage, 0.1);
      EXPECT_LE(state.max_damage, 1.0);
      const std::vector<char> flags = broken_bonds(body.model, history);
      ASSERT_EQ(flags.size(), kappas.size());
      for (std::size_t b = 0; b < flags.size(); ++b) {
        EXPECT_EQ(flags[b] != 0, kappas[b] >= wide_critical);
      }
    }
  }
}

TEST(Damage, WithoutHistoryIsWhatACrackHasCut) {
  const BoxBody body(tests::small_box(2));
  const auto n = std::size_t(body.points.count());
  std::vector<double> cut(n, 0.0), damage(n, 1e300);
  cut[3] = 1.0;
  const DamageState state = assess_damage(body.model, {}, cut, damage);
  double weight = 0.0;
  tests::for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset b) {
    if (i == 3 || j == 3) weight += body.model.bonds().weight(b);
  });
  for (std::size_t p = 0; p < n; ++p) {
    EXPECT_NEAR(damage[p], p == 3 ? 1.0 / (1.0 + weight) : 0.0, 1e-14);
  }
  EXPECT_EQ(state.max_damage, damage[3]);
  EXPECT_EQ(state.dissipated_energy, 0.0);
  EXPECT_EQ(state.broken_bonds, 0);
  EXPECT_TRUE(broken_bonds(body.model, {}).empty());
}

TEST(Damage, EnergyTakenUpIsStoredOrDissipated) {
  const std::vector<std::function<BondPotential(double)>> laws{
      softening,
      [](double c) {
        return Degraded<TanhDegradation>{c, {wide_onset, wide_critical, rate}};
      },
      [](double c) {
        return Degraded<CriticalStretch>{c, {0.2}};
      }};
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (std::size_t law = 0; law < laws.size(); ++law) {
      SCOPED_TRACE(std::to_string(dimension) + "D, law " + std::to_string(law));
      tests::BoxSetting box = softening_box(dimension);
      box.potential = laws[law];
      const BoxBody body(box);
      Assembler assembler(body.points, body.model, 2);
      History history = assembler.initial_history();
      std::vector<double> damage(body.points.volume.size());
      double dissipated = 0.0;
      int grew = 0;
      for (const double strain : {0.05, 0.15, 0.0, 0.3, 0.2, 0.7}) {
        const std::vector<double> state = pulled_state(body, 30, strain);
        std::vector<double> before(body.dofs()), after(body.dofs());
        const double taken_up = assembler.gradient({state, history}, before).energy;
        const Evaluation found = assembler.commit(state, history, after);
        const double now = assess_damage(body.model, history, {}, damage).dissipated_energy;
        // Sums of some hundred terms.
        EXPECT_NEAR(found.energy + now - dissipated, taken_up, 1e-13 * (taken_up + now));
        EXPECT_LE(distance(before, after), 1e-14 * norm(before));
        EXPECT_EQ(assembler.energy({state, history}).energy, found.energy);
        EXPECT_EQ(found.released, 0.0);
        EXPECT_GE(now, dissipated);
        grew += now > dissipated;
        dissipated = now;
      }
      EXPECT_GE(grew, 2);
    }
  }
}

TEST(Damage, IsTheSameOnAnyNumberOfThreads) {
  for (const auto& box : softening_boxes()) {
    SCOPED_TRACE(told(box));
    const BoxBody body(box);
    struct Result {
      std::vector<double> history, gradient;
      std::vector<double> energies;
      std::vector<Index> counts;
    };
    const auto run = [&](int threads) {
      Assembler assembler(body.points, body.model, threads);
      History history = assembler.initial_history();
      Result result;
      result.gradient.resize(body.dofs());
      for (const double strain : {0.05, 0.2, 0.0, 0.6}) {
        const std::vector<double> state = pulled_state(body, 40, strain);
        const DamageGrowth growth = assembler.growth({state, history});
        const Evaluation found = assembler.commit(state, history, result.gradient);
        result.energies.insert(result.energies.end(),
                               {found.energy, found.released, growth.utilisation});
        result.counts.insert(result.counts.end(), {growth.degrading, growth.breaking,
                                                   found.growth.degrading, found.growth.breaking});
      }
      const std::span<const double> kappas = bond_stretches(body.model, history);
      result.history.assign(kappas.begin(), kappas.end());
      return result;
    };
    const Result one = run(1);
    ASSERT_GT(one.counts.back(), 0);
    for (const int threads : {2, 3}) {
      const Result several = run(threads);
      EXPECT_EQ(several.history, one.history);  // each bond by itself
      EXPECT_EQ(several.counts, one.counts);
      // Sums of some ten (gradient) or hundred terms in another order; what is released is a
      // difference of two of them.
      EXPECT_LE(distance(several.gradient, one.gradient), 1e-14 * 32 * norm(one.gradient));
      EXPECT_LE(distance(several.energies, one.energies), 1e-13 * norm(one.energies));
    }
  }
}

// ---- Triangles and tetrahedra

/// Energy of the triangles of a plane body by eq. 14 of [CPD], over ordered pairs, each times the
/// integrities of its three bonds.
double energy_of_triangles(const BoxBody& body, const tests::BoxSetting& box,
                           const std::vector<double>& state, std::span<const double> history) {
  const Points& points = body.points;
  const auto n = std::size_t(points.count());
  std::vector<double> integrity(n * n, -1.0);  // negative: no bond
  tests::for_each_bond(body.model.bonds(), [&](Index i, Index j, Offset b) {
    integrity[std::size_t(i) * n + j] = integrity[std::size_t(j) * n + i] = softened(history[b]);
  });
  const auto area = [&](std::size_t i, std::size_t j, std::size_t k, bool current) {
    const auto arm = [&](std::size_t to, int c) {
      double along = points.position(Index(to))[c] - points.position(Index(i))[c];
      if (current) along += state[to * 2 + c] - state[i * 2 + c];
      return along;
    };
    return arm(j, 0) * arm(k, 1) - arm(j, 1) * arm(k, 0);
  };
  const auto bulk = bulk_neighbourhood(2, box.spacing, body.setting.horizon, box.cross_section);
  const double c2 = std::get<Harmonic>(body.simplex_term()->triangles()->potential).modulus;
  double energy = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    double neighbours = 0.0, pairs = 0.0, psi = 0.0;
    for (std::size_t j = 0; j < n; ++j) {
      if (integrity[i * n + j] < 0.0) continue;
      ++neighbours;
      for (std::size_t k = 0; k < n; ++k) {
        if (integrity[i * n + k] < 0.0 || integrity[j * n + k] < 0.0) continue;
        const double reference = area(i, j, k, false);
        const double factor = flatness_factor(std::abs(reference) / (box.spacing * box.spacing));
        if (factor == 0.0) continue;
        pairs += factor;
        const double change = area(i, j, k, true) / reference - 1.0;
        psi += integrity[i * n + j] * integrity[i * n + k] * integrity[j * n + k] * 0.5 * factor *
               std::abs(reference) * change * change;
      }
    }
    const double v_h = bulk.volume * neighbours / double(bulk.neighbours);
    if (pairs > 0.0) energy += points.volume[i] * v_h * v_h / pairs / 3.0 * c2 * psi;
  }
  return energy;
}

TEST(DamageOfTriangles, TakesTheProductOfTheirBondsIntegrities) {
  for (const bool stored : {false, true}) {
    SCOPED_TRACE(stored);
    tests::BoxSetting box = softening_box(2);
    box.triangles = 1.0;
    box.stored = stored;
    const BoxBody body(box);
    tests::BoxSetting without = box;
    without.triangles = 0.0;
    const BoxBody bonds_alone(without);
    Assembler assembler(body.points, body.model, 2),
        of_bonds(bonds_alone.points, bonds_alone.model, 2);
    History history = assembler.initial_history(), history_of_bonds = of_bonds.initial_history();
    const auto of_triangles = [&](const std::vector<double>& state) {
      return assembler.energy({state, history}).energy -
             of_bonds.energy({state, history_of_bonds}).energy;
    };
    int released = 0;
    for (const double strain : {0.0, 0.1, 0.05, 0.4}) {
      const std::vector<double> state =
          strain == 0.1 ? damaging_state(body) : pulled_state(body, 50, strain);
      const double before = of_triangles(state);
      const Evaluation committed = assembler.commit(state, history);
      (void)of_bonds.commit(state, history_of_bonds);
      const std::span<const double> kappas = bond_stretches(body.model, history);
      const std::span<const double> kappas_of_bonds =
          bond_stretches(bonds_alone.model, history_of_bonds);
      ASSERT_TRUE(std::equal(kappas.begin(), kappas.end(), kappas_of_bonds.begin()));
      const double after = of_triangles(state);
      const double scale = assembler.energy({state, history}).energy;
      // Differences of energies that are sums of some hundred terms.
      EXPECT_NEAR(after, energy_of_triangles(body, box, state, kappas), 1e-12 * scale);
      EXPECT_NEAR(committed.released, before - after, 1e-12 * scale);
      EXPECT_NEAR(committed.energy, scale, 1e-14 * scale);
      EXPECT_GT(before, 1e-3 * scale);
      released += committed.released > 1e-3 * before;
      // At another state, too.
      const std::vector<double> other = body.random_state(51);
      EXPECT_NEAR(of_triangles(other), energy_of_triangles(body, box, other, kappas),
                  1e-12 * assembler.energy({other, history}).energy);
    }
    EXPECT_GE(released, 2);
    EXPECT_EQ(assembler.commit(body.random_state(51), history).released, 0.0);  // damages nothing
  }
}

TEST(DamageOfTriangles, LedgerOfACommitClosesInEveryBody) {
  for (const auto& box : softening_boxes()) {
    if (box.triangles == 0.0) continue;
    SCOPED_TRACE(told(box));
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    History history = assembler.initial_history();
    std::vector<double> damage(body.points.volume.size());
    double dissipated = 0.0;
    int released = 0;
    for (const double strain : {0.05, 0.15, 0.1, 0.5}) {
      const std::vector<double> state = pulled_state(body, 60, strain);
      const double taken_up = assembler.energy({state, history}).energy;
      const Evaluation found = assembler.commit(state, history);
      const double now = assess_damage(body.model, history, {}, damage).dissipated_energy;
      EXPECT_NEAR(found.energy + (now - dissipated) + found.released, taken_up, 1e-12 * taken_up);
      EXPECT_GE(found.released, 0.0);
      released += found.released > 1e-3 * taken_up;
      dissipated = now;
    }
    EXPECT_GE(released, 2);
  }
}

// Steps so small that what is released is round-off of what is stored, and large ones.
TEST(DamageOfTriangles, NeverReleasesLessThanNothing) {
  for (const auto& box : softening_boxes()) {
    if (box.triangles == 0.0) continue;
    SCOPED_TRACE(told(box));
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    History history = assembler.initial_history();
    int damaging = 0;
    for (double strain = 0.05; strain < 0.4; strain *= damaging % 3 == 2 ? 1.2 : 1.0 + 1e-12) {
      const Evaluation found = assembler.commit(pulled_state(body, 70, strain), history);
      ASSERT_GE(found.released, 0.0) << strain;
      damaging += found.growth.degrading > 0;
      if (found.growth.degrading == 0) strain *= 1.1;
    }
    EXPECT_GT(damaging, 5);
  }
}

TEST(DamageOfTriangles, IsRefusedToThoseThatHoldNegativeEnergy) {
  for (const double stiffness : {-0.1, 0.1}) {
    tests::BoxSetting box = softening_box(3);
    for (const bool tetrahedra : {false, true}) {
      box.triangles = tetrahedra ? 0.1 : stiffness;
      box.tetrahedra = tetrahedra ? stiffness : 0.1;
      if (stiffness > 0.0) {
        EXPECT_NO_THROW(BoxBody{box});
      } else {
        EXPECT_THROW(BoxBody{box}, std::logic_error);
        tests::BoxSetting elastic = box;
        elastic.potential = {};
        EXPECT_NO_THROW(BoxBody{elastic});
      }
    }
  }
}

}  // namespace
}  // namespace peristat
