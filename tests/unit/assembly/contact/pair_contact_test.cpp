#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/operators/tangent.hpp"
#include "tests/finite_differences.hpp"
#include "tests/unit/assembly/contact/halves.hpp"

namespace peristat {
namespace {

using tests::dot;
using tests::norm;
using tests::Random;

using tests::gradient_at;
using tests::Halves;
using tests::modulus;
using tests::spacing;

class PairContact : public ::testing::TestWithParam<int> {};

TEST_P(PairContact, ForcesAreTheDerivativeOfTheEnergy) {
  const Halves halves(GetParam());
  Model alone(halves.body.model.bonds());
  alone.add(halves.contact);
  Assembler assembler(halves.body.points, alone, 1);
  const std::vector<double> at = halves.pressed();
  const std::vector<double> v = Random(5).vector(at.size());
  const auto energy = [&](double t) {
    std::vector<double> there = at;
    for (std::size_t k = 0; k < at.size(); ++k) there[k] += t * v[k];
    return std::vector{assembler.energy(there).energy};
  };
  EXPECT_TRUE(tests::is_derivative(energy, {dot(gradient_at(assembler, at), v)}, 1e-4 * spacing));
}

TEST_P(PairContact, TangentAndProductAreTheDerivativeOfTheForces) {
  Halves halves(GetParam());
  Assembler assembler(halves.body.points, halves.body.model, 2);
  const std::vector<double> at = halves.pressed();
  const std::vector<double> v = Random(5).vector(at.size());
  std::vector<double> product(at.size()), stored(at.size());
  assembler.product(at, v, product);
  const auto forces = [&](double t) {
    std::vector<double> there = at;
    for (std::size_t k = 0; k < at.size(); ++k) there[k] += t * v[k];
    return gradient_at(assembler, there);
  };
  EXPECT_TRUE(tests::is_derivative(forces, product, 1e-4 * spacing));
  Tangent tangent(assembler);
  tangent.linearise(assembler, at, 0.0);
  tangent.multiply(v, stored);
  EXPECT_LE(tests::distance(stored, product), 1e-13 * norm(product));
}

TEST_P(PairContact, ForcesAndMomentsBalance) {
  const Halves halves(GetParam());
  Model alone(halves.body.model.bonds());
  alone.add(halves.contact);
  Assembler assembler(halves.body.points, alone, 1);
  const std::vector<double> at = halves.pressed(), gradient = gradient_at(assembler, at);
  ASSERT_GT(norm(gradient), 0.0);
  tests::expect_balance(halves, at, gradient);
}

TEST_P(PairContact, RestAndOpenFacesAreFreeOfForce) {
  Halves halves(GetParam());
  Model alone(halves.body.model.bonds());
  alone.add(halves.contact);
  Assembler assembler(halves.body.points, alone, 1);
  EXPECT_EQ(norm(gradient_at(assembler, std::vector<double>(halves.body.dofs()))), 0.0);
  EXPECT_EQ(norm(gradient_at(assembler, halves.moved(0.05, 0.0, 0.0))), 0.0);
}

/// Pairs that were found elsewhere give the same forces as those found here, bit for bit.
TEST_P(PairContact, ResultsDoNotDependOnEarlierStates) {
  const Halves halves(GetParam());
  Model alone(halves.body.model.bonds());
  alone.add(halves.contact);
  Assembler one(halves.body.points, alone, 1), other(halves.body.points, alone, 2);
  const std::vector<double> at = halves.pressed();
  for (const double along : {0.0, 3.0, 0.1, -0.02}) {
    static_cast<void>(other.energy(halves.moved(along, 0.0, 0.01)));
  }
  EXPECT_EQ(gradient_at(one, at), gradient_at(other, at));
  EXPECT_EQ(one.energy(at).energy, other.energy(at).energy);
}

/// A projected tangent has no negative curvature across the contacts.
TEST_P(PairContact, ProjectedTangentIsPositive) {
  const Halves halves(GetParam());
  Model alone(halves.body.model.bonds());
  alone.add(halves.contact);
  Assembler assembler(halves.body.points, alone, 1);
  const std::vector<double> at = halves.pressed();
  std::vector<double> product(at.size());
  double exact = 0.0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const std::vector<double> v = Random(seed).vector(at.size());
    assembler.product(at, v, product, 1.0);
    EXPECT_GE(dot(v, product), 0.0);
    exact += dot(v, product);
    assembler.product(at, v, product, 0.0);
    exact -= dot(v, product);
  }
  EXPECT_GE(exact, GetParam() > 1 ? 1e-12 : -1e-12);
}

TEST_P(PairContact, BeyondTheLargestDepthThereIsNoState) {
  const Halves halves(GetParam());
  Assembler assembler(halves.body.points, halves.body.model, 1);
  EXPECT_FALSE(assembler.energy(halves.moved(-0.2, 0.0, 0.0)).degenerate);
  EXPECT_TRUE(assembler.energy(halves.moved(-0.26, 0.0, 0.0)).degenerate);
  std::vector<double> lost = halves.moved(0.0, 0.0, 0.0);
  lost[0] = std::nan("");
  EXPECT_TRUE(assembler.energy(lost).degenerate);
}

/// However far the upper half flies, it stops nine tenths of the way to nine tenths of the largest
/// depth: on opposite points of the two faces.
TEST_P(PairContact, StepEndsBeforeFacesPassThroughOneAnother) {
  const Halves halves(GetParam());
  Assembler assembler(halves.body.points, halves.body.model, 1);
  const auto d = std::size_t(GetParam());
  for (const double far : {0.3, 1.0, 40.0}) {
    const std::vector<double> at = halves.moved(0.05, 0.0, 0.0);
    std::vector<double> step(at.size());
    for (Index i = 0; i < halves.body.points.count(); ++i) {
      if (halves.is_above(i)) step[std::size_t(i) * d + d - 1] = -far * spacing;
    }
    EXPECT_NEAR(assembler.longest_step(at, step), 0.9 * (0.05 + 0.9 * 0.25) / far, 1e-12);
    for (double& component : step) component = -component;
    EXPECT_EQ(assembler.longest_step(at, step), 1.0);
  }
  std::vector<double> all_alike(halves.body.dofs(), 40.0 * spacing);
  EXPECT_EQ(assembler.longest_step(std::vector<double>(halves.body.dofs()), all_alike), 1.0);
}

/// Random steps of every length: the first time is that of all pairs, one by one.
TEST_P(PairContact, LongestStepIsThatOfAllPairs) {
  const Halves halves(GetParam());
  Assembler assembler(halves.body.points, halves.body.model, 1);
  const Points& points = halves.body.points;
  const auto d = std::size_t(GetParam());
  const std::vector<double> at = halves.moved(0.3, 0.0, 0.02);
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const double far = seed % 3 == 0 ? 0.2 : seed % 3 == 1 ? 2.0 : 30.0;
    const std::vector<double> step = Random(seed).vector(at.size(), far * spacing);
    double first = 2.0;
    for (Index i = 0; i < points.count(); ++i) {
      for (Index j = i + 1; j < points.count(); ++j) {
        ContactPair pair;
        if (!halves.contact->contacts().pairs.find_pair(i, j, pair)) continue;
        const double least = (1.0 - 0.9 * 0.25) * pair.distance;
        double a = 0.0, b = 0.0, c = -least * least;
        for (std::size_t k = 0; k < d; ++k) {
          const double arm = points.position(j)[k] - points.position(i)[k] +
                             at[std::size_t(j) * d + k] - at[std::size_t(i) * d + k];
          const double v = step[std::size_t(j) * d + k] - step[std::size_t(i) * d + k];
          a += v * v;
          b += 2.0 * arm * v;
          c += arm * arm;
        }
        const double root = b * b - 4.0 * a * c;
        if (c > 0.0 && b < 0.0 && root >= 0.0) {
          first = std::min(first, (-b - std::sqrt(root)) / (2.0 * a));
        }
      }
    }
    const double expected = first <= 1.0 ? 0.9 * first : 1.0;
    EXPECT_NEAR(assembler.longest_step(at, step), expected, 1e-9) << far;
  }
}

/// Halves that were far apart touch: their points join the pattern, and leave it again.
TEST_P(PairContact, PatternGrowsWithContacts) {
  Halves halves(GetParam());
  Assembler assembler(halves.body.points, halves.body.model, 1);
  Tangent tangent(assembler);
  const Offset before = tangent.pattern.blocks();
  tangent.linearise(assembler, halves.pressed(), 0.0);
  EXPECT_GT(tangent.pattern.blocks(), before);
  const int version = tangent.version;
  tangent.linearise(assembler, halves.moved(-0.1, 0.0, 0.0), 0.0);
  EXPECT_EQ(tangent.version, version);  // what covers a state is kept
  const std::vector<double> apart = halves.moved(30.0, 0.0, 0.0);
  StateView predictor(apart);
  predictor.foreseen = apart;
  tangent.linearise(assembler, predictor, 0.0);
  EXPECT_EQ(tangent.pattern.blocks(), before);
}

/// A predictor counts the contacts that the foreseen state closes as straight springs.
TEST_P(PairContact, ForeseenContactsAreSprings) {
  const Halves halves(GetParam());
  Model alone(halves.body.model.bonds());
  alone.add(halves.contact);
  Assembler assembler(halves.body.points, alone, 1);
  const std::vector<double> open = halves.moved(0.02, 0.0, 0.0);
  const std::vector<double> closed = halves.moved(-0.02, 0.0, 0.0);
  StateView at(open);
  at.foreseen = open;
  EXPECT_TRUE(assembler.closed_contacts(at).empty());
  EXPECT_EQ(assembler.energy(at).energy, 0.0);
  at.foreseen = closed;
  const std::size_t pairs = assembler.closed_contacts(at).size() / 2;
  const std::size_t across = GetParam() == 1 ? 1 : GetParam() == 2 ? 9 : 16;
  EXPECT_EQ(pairs, across);
  const double section = GetParam() == 3   ? spacing * spacing
                         : GetParam() == 2 ? 0.5 * spacing
                                           : 0.5;
  const double stiffness = modulus * section / spacing, gap = 0.02 * spacing;
  EXPECT_NEAR(assembler.energy(at).energy, double(across) * 0.5 * stiffness * gap * gap,
              1e-9 * stiffness * gap * gap);
  std::vector<double> gradient(open.size());
  EXPECT_FALSE(assembler.gradient(at, gradient).degenerate);
  EXPECT_NEAR(*std::ranges::max_element(gradient), stiffness * gap, 1e-9 * stiffness * gap);
  EXPECT_NEAR(*std::ranges::min_element(gradient), -stiffness * gap, 1e-9 * stiffness * gap);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, PairContact, ::testing::Values(1, 2, 3),
                         [](const auto& param) { return std::to_string(param.param) + "D"; });

/// What bonds lose, contact takes over: without damage there is none, and after a break the force
/// does not jump where the pair is stretched.
TEST(PairContactOfBonds, TakesOverWhatBondsLose) {
  const Halves halves(2, {}, true);
  Assembler assembler(halves.body.points, halves.body.model, 1);
  History history = assembler.initial_history();
  const std::vector<double> pressed = halves.moved(-0.1, 0.0, 0.0);
  std::vector<double> with(pressed.size()), without(pressed.size());
  Model bonds_alone = halves.body.bonds_alone();
  Assembler alone(halves.body.points, bonds_alone, 1);
  static_cast<void>(assembler.gradient({pressed, history}, with));
  static_cast<void>(alone.gradient({pressed, history}, without));
  EXPECT_EQ(with, without);
  const std::vector<double> torn = halves.moved(0.6, 0.0, 0.0);
  const Evaluation broken = assembler.commit(torn, history);
  EXPECT_GT(broken.growth.breaking, 0);
  static_cast<void>(assembler.gradient({torn, history}, with));
  static_cast<void>(alone.gradient({torn, history}, without));
  EXPECT_EQ(with, without);
  static_cast<void>(assembler.gradient({pressed, history}, with));
  static_cast<void>(alone.gradient({pressed, history}, without));
  EXPECT_GT(tests::distance(with, without), 0.0);
}

/// A bar of two points in contact: the law of the sheet in closed form.
TEST(PairContactForce, IsThatOfTheLaw) {
  PairContactRule rule;
  rule.stiffness = 2.0;
  rule.depth = 0.3;
  rule.law.bend = 0.01;
  const Halves halves(1, rule);
  Model alone(halves.body.model.bonds());
  alone.add(halves.contact);
  Assembler assembler(halves.body.points, alone, 1);
  const double depth = 0.4, deepest = 0.3 * spacing;
  const std::vector<double> gradient = gradient_at(assembler, halves.moved(-0.12, 0.0, 0.0));
  const double stiffness = 2.0 * modulus * 0.5 / spacing;
  const double s = depth - 0.005, force = stiffness * deepest * s / (1.0 - s);
  EXPECT_NEAR(*std::ranges::max_element(gradient), force, 1e-10 * force);
  EXPECT_NEAR(*std::ranges::min_element(gradient), -force, 1e-10 * force);
}

}  // namespace
}  // namespace peristat
