// Contact of points with faces: derivatives, balances, sliding without bumps, steps, friction.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/operators/tangent.hpp"
#include "tests/finite_differences.hpp"
#include "tests/unit/assembly/contact/halves.hpp"

namespace peristat {
namespace {

using tests::dot;
using tests::gradient_at;
using tests::Halves;
using tests::modulus;
using tests::norm;
using tests::Random;
using tests::spacing;

PairContactRule faces(double friction = 0.0) {
  PairContactRule rule;
  rule.has_faces = true;
  rule.friction = friction;
  return rule;
}

class FaceContact : public ::testing::TestWithParam<int> {
 protected:
  FaceContact() : halves_(GetParam(), faces()), alone_(halves_.alone()) {}
  [[nodiscard]] std::size_t d() const { return std::size_t(GetParam()); }
  /// Points that face the other half, on the lower side.
  [[nodiscard]] std::vector<Index> lower_face() const {
    std::vector<Index> face;
    const double height = d() == 2 ? 0.35 : 0.25;
    for (Index i = 0; i < halves_.body.points.count(); ++i) {
      if (std::abs(halves_.body.points.position(i)[d() - 1] - height) < 1e-6) face.push_back(i);
    }
    return face;
  }

  const Halves halves_;
  const Model alone_;
};

TEST_P(FaceContact, LeavesNothingToPointsOfTheTwoFaces) {
  ASSERT_FALSE(halves_.contacts->faces.none());
  Model pairs(halves_.body.model.bonds());
  pairs.add(halves_.contact);
  Assembler assembler(halves_.body.points, pairs, 1);
  EXPECT_EQ(norm(gradient_at(assembler, halves_.moved(-0.1, 0.3, 0.01))), 0.0);
}

TEST_P(FaceContact, ForcesAreTheDerivativeOfTheEnergy) {
  Assembler assembler(halves_.body.points, alone_, 1);
  for (const double aside : {0.05, 0.37}) {
    const std::vector<double> at = halves_.moved(-0.1, aside, 0.02);
    const std::vector<double> v = Random(5).vector(at.size());
    const auto energy = [&](double t) {
      std::vector<double> there = at;
      for (std::size_t k = 0; k < at.size(); ++k) there[k] += t * v[k];
      return std::vector{assembler.energy(there).energy};
    };
    EXPECT_TRUE(tests::is_derivative(energy, {dot(gradient_at(assembler, at), v)}, 1e-5 * spacing));
  }
}

TEST_P(FaceContact, TangentAndProductAreTheDerivativeOfTheForces) {
  Assembler assembler(halves_.body.points, halves_.body.model, 2);
  const std::vector<double> at = halves_.moved(-0.1, 0.37, 0.02);
  const std::vector<double> v = Random(5).vector(at.size());
  std::vector<double> product(at.size()), stored(at.size());
  assembler.product(at, v, product);
  const auto forces = [&](double t) {
    std::vector<double> there = at;
    for (std::size_t k = 0; k < at.size(); ++k) there[k] += t * v[k];
    return gradient_at(assembler, there);
  };
  EXPECT_TRUE(tests::is_derivative(forces, product, 1e-5 * spacing));
  Tangent tangent(assembler);
  tangent.linearise(assembler, at, 0.0);
  tangent.multiply(v, stored);
  EXPECT_LE(tests::distance(stored, product), 1e-13 * norm(product));
}

TEST_P(FaceContact, ForcesAndMomentsBalance) {
  Assembler assembler(halves_.body.points, alone_, 1);
  const std::vector<double> at = halves_.moved(-0.12, 0.3, 0.02);
  const std::vector<double> gradient = gradient_at(assembler, at);
  ASSERT_GT(norm(gradient), 0.0);
  tests::expect_balance(halves_, at, gradient);
}

TEST_P(FaceContact, RestAndOpenFacesAreFreeOfForce) {
  Assembler assembler(halves_.body.points, alone_, 1);
  EXPECT_EQ(norm(gradient_at(assembler, std::vector<double>(halves_.body.dofs()))), 0.0);
  EXPECT_EQ(norm(gradient_at(assembler, halves_.moved(0.05, 0.4, 0.0))), 0.0);
}

/// A flat half slides over a flat half: inside, where every face has its whole neighbourhood, the
/// forces press along the normal alone, and are those of the law, wherever the points stand.
/// Contact of points has forces across of the same size.
TEST_P(FaceContact, FlatFacesSlideWithoutBumps) {
  Assembler assembler(halves_.body.points, alone_, 1);
  const ContactLaw law = faces().law;
  const double section = d() == 2 ? 0.5 * spacing : spacing * spacing;
  const double press = 0.5 * modulus * section / spacing * 0.25 * spacing * law(0.1 / 0.25).first;
  for (const double aside : {0.0, 0.13, 0.5, 0.77, 1.0}) {
    const std::vector<double> gradient = gradient_at(assembler, halves_.moved(-0.1, aside, 0.0));
    double inside = 0.0;
    for (const Index i : lower_face()) {
      const Coordinates at = halves_.body.points.position(i);
      const double width = d() == 2 ? 0.9 : 0.4;
      const bool is_inside =
          at[0] > 0.2 && at[0] < width - 0.1 && (d() == 2 || (at[1] > 0.1 && at[1] < width - 0.1));
      if (!is_inside) continue;
      for (std::size_t c = 0; c + 1 < d(); ++c) {
        EXPECT_NEAR(gradient[std::size_t(i) * d() + c], 0.0, 1e-12 * press);
      }
      // Its own half, and the half of the points above that press on its facets.
      EXPECT_NEAR(gradient[std::size_t(i) * d() + d() - 1], 2.0 * press,
                  (d() == 2 ? 1e-12 : 1.0) * press);
      inside += 1.0;
    }
    EXPECT_GT(inside, 0.0);
  }
}

/// Facets that were found elsewhere give the same forces as those found here, bit for bit.
TEST_P(FaceContact, ResultsDoNotDependOnEarlierStates) {
  Assembler one(halves_.body.points, alone_, 1), other(halves_.body.points, alone_, 2);
  const std::vector<double> at = halves_.pressed();
  for (const double along : {0.0, 3.0, 0.1, -0.02}) {
    static_cast<void>(other.energy(halves_.moved(along, 0.0, 0.01)));
  }
  EXPECT_EQ(gradient_at(one, at), gradient_at(other, at));
  EXPECT_EQ(one.energy(at).energy, other.energy(at).energy);
}

TEST_P(FaceContact, ProjectedTangentIsPositive) {
  Assembler assembler(halves_.body.points, alone_, 1);
  const std::vector<double> at = halves_.moved(-0.15, 0.3, 0.05);
  std::vector<double> product(at.size());
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const std::vector<double> v = Random(seed).vector(at.size());
    assembler.product(at, v, product, 1.0);
    EXPECT_GE(dot(v, product), 0.0);
  }
}

TEST_P(FaceContact, BeyondTheLargestDepthThereIsNoState) {
  Assembler assembler(halves_.body.points, halves_.body.model, 1);
  EXPECT_FALSE(assembler.energy(halves_.moved(-0.2, 0.4, 0.0)).degenerate);
  EXPECT_TRUE(assembler.energy(halves_.moved(-0.26, 0.4, 0.0)).degenerate);
  std::vector<double> lost = halves_.moved(0.0, 0.0, 0.0);
  lost[0] = std::nan("");
  EXPECT_TRUE(assembler.energy(lost).degenerate);
}

/// However far the upper half flies, and wherever it stands, it stops before it passes the face:
/// within the thousandth of the way that the search for the time leaves.
TEST_P(FaceContact, StepEndsBeforeFacesPassThroughOneAnother) {
  Assembler assembler(halves_.body.points, halves_.body.model, 1);
  for (const double far : {0.3, 1.0, 40.0}) {
    for (const double aside : {0.0, 0.41}) {
      const std::vector<double> at = halves_.moved(0.05, aside, 0.0);
      std::vector<double> step(at.size());
      for (Index i = 0; i < halves_.body.points.count(); ++i) {
        if (halves_.is_above(i)) step[std::size_t(i) * d() + d() - 1] = -far * spacing;
      }
      const double whole = 0.9 * (0.05 + 0.9 * 0.25) / far;
      EXPECT_LE(assembler.longest_step(at, step), whole * (1.0 + 1e-12));
      EXPECT_GE(assembler.longest_step(at, step), whole - 1e-3 / far);
      std::vector<double> there = at;
      for (std::size_t k = 0; k < at.size(); ++k) there[k] += step[k];
      if (far > 2.0) {
        EXPECT_TRUE(assembler.has_passed(at, there));
      }
      for (double& component : step) component = -component;
      EXPECT_EQ(assembler.longest_step(at, step), 1.0);
    }
  }
  std::vector<double> all_alike(halves_.body.dofs(), 40.0 * spacing);
  EXPECT_EQ(assembler.longest_step(std::vector<double>(halves_.body.dofs()), all_alike), 1.0);
}

TEST_P(FaceContact, PatternGrowsWithContacts) {
  Assembler assembler(halves_.body.points, halves_.body.model, 1);
  Tangent tangent(assembler);
  const Offset before = tangent.pattern.blocks();
  tangent.linearise(assembler, halves_.pressed(), 0.0);
  EXPECT_GT(tangent.pattern.blocks(), before);
  const int version = tangent.version;
  tangent.linearise(assembler, halves_.moved(-0.1, 0.0, 0.0), 0.0);
  EXPECT_EQ(tangent.version, version);  // what covers a state is kept
  const std::vector<double> apart = halves_.moved(30.0, 0.0, 0.0);
  StateView predictor(apart);
  predictor.foreseen = apart;
  tangent.linearise(assembler, predictor, 0.0);
  EXPECT_EQ(tangent.pattern.blocks(), before);
}

/// A predictor counts the contacts that the foreseen state closes as straight springs: a spring
/// for each point of both faces, with half of the stiffness.
TEST_P(FaceContact, ForeseenContactsAreSprings) {
  Assembler assembler(halves_.body.points, alone_, 1);
  const std::vector<double> open = halves_.moved(0.02, 0.0, 0.0);
  const std::vector<double> closed = halves_.moved(-0.02, 0.0, 0.0);
  StateView at(open);
  at.foreseen = open;
  EXPECT_TRUE(assembler.closed_contacts(at).empty());
  EXPECT_EQ(assembler.energy(at).energy, 0.0);
  at.foreseen = closed;
  const std::size_t across = GetParam() == 2 ? 9 : 16;
  EXPECT_EQ(assembler.closed_contacts(at).size(), 2 * across);
  const double section = GetParam() == 3 ? spacing * spacing : 0.5 * spacing;
  const double stiffness = modulus * section / spacing, gap = 0.02 * spacing;
  EXPECT_NEAR(assembler.energy(at).energy, double(across) * 0.5 * stiffness * gap * gap,
              1e-9 * stiffness * gap * gap);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, FaceContact, ::testing::Values(2, 3),
                         [](const auto& param) { return std::to_string(param.param) + "D"; });

/// Friction of faces and of pairs of points: the rule, and the dimension.
struct Rubs {
  bool has_faces;
  int dimension;
};

class PointFrictionOf : public ::testing::TestWithParam<Rubs> {
 protected:
  PointFrictionOf()
      : halves_(GetParam().dimension, rule()),
        alone_(halves_.alone()),
        assembler_(halves_.body.points, alone_, 1) {}
  static PairContactRule rule() {
    PairContactRule rule = faces(coefficient);
    rule.has_faces = GetParam().has_faces;
    return rule;
  }
  [[nodiscard]] History lagged(const std::vector<double>& from, const std::vector<double>& to,
                               const History& before) {
    History history = before;
    static_cast<void>(
        assembler_.lag_friction(StateView(to, before), StateView(from, before), history));
    return history;
  }
  /// Force on the upper half.
  [[nodiscard]] Coordinates force(const std::vector<double>& at, const History& history) {
    std::vector<double> gradient(at.size());
    static_cast<void>(assembler_.gradient({at, history}, gradient));
    Coordinates sum{};
    const auto d = std::size_t(halves_.dimension());
    for (Index i = 0; i < halves_.body.points.count(); ++i) {
      for (std::size_t c = 0; c < d && halves_.is_above(i); ++c) {
        sum[c] -= gradient[std::size_t(i) * d + c];
      }
    }
    return sum;
  }

  static constexpr double coefficient = 0.4;
  const Halves halves_;
  const Model alone_;
  Assembler assembler_;
};

/// Rows of points climb over one another, so that what follows holds for faces alone.
class FaceFriction : public PointFrictionOf {};

TEST_P(PointFrictionOf, ForcesAndTangentAreDerivatives) {
  const std::vector<double> before = halves_.moved(-0.1, 0.0, 0.02);
  for (const double aside : {0.02, 0.3}) {  // some stick, all slide
    const std::vector<double> at = halves_.moved(-0.1, aside, 0.02);
    const History history = lagged(before, at, {});
    const std::vector<double> v = Random(5).vector(at.size());
    const auto moved = [&](double t) {
      std::vector<double> there = at;
      for (std::size_t k = 0; k < at.size(); ++k) there[k] += t * v[k];
      return there;
    };
    const auto gradient_of = [&](double t) {
      std::vector<double> gradient(at.size());
      const std::vector<double> there = moved(t);
      static_cast<void>(assembler_.gradient({there, history}, gradient));
      return gradient;
    };
    const auto energy = [&](double t) {
      const std::vector<double> there = moved(t);
      return std::vector{assembler_.energy({there, history}).energy};
    };
    EXPECT_TRUE(tests::is_derivative(energy, {dot(gradient_of(0.0), v)}, 1e-5 * spacing));
    std::vector<double> product(at.size()), stored(at.size());
    assembler_.product({at, history}, v, product);
    EXPECT_TRUE(tests::is_derivative(gradient_of, product, 1e-5 * spacing));
    Tangent tangent(assembler_);
    tangent.linearise(assembler_, {at, history}, 0.0);
    tangent.multiply(v, stored);
    EXPECT_LE(tests::distance(stored, product), 1e-13 * norm(product));
  }
}

/// Flat halves: the friction is mu times the normal force once they slide, less before; forces
/// add up to zero; commits dissipate the work of the sliding part, and sticking creeps nowhere.
TEST_P(FaceFriction, SticksAndSlides) {
  const std::vector<double> pressed = halves_.moved(-0.1, 0.0, 0.0);
  History history = lagged(pressed, pressed, {});
  static_cast<void>(assembler_.commit(pressed, history));
  const double normal = force(pressed, history).at(std::size_t(halves_.dimension()) - 1);
  ASSERT_GT(normal, 0.0);
  const std::vector<double> stuck = halves_.moved(-0.1, 0.01, 0.0);
  for (int again = 0; again < 5; ++again) {
    const History now = lagged(pressed, stuck, history);
    const Coordinates sticks = force(stuck, now);
    EXPECT_LT(std::abs(sticks[0]), coefficient * normal);
    EXPECT_LT(sticks[0], -0.01 * normal);
    History next = now;
    EXPECT_NEAR(assembler_.commit(stuck, next).released, 0.0, 1e-15);
    EXPECT_NEAR(force(stuck, next)[0], sticks[0], 1e-12 * normal);
    EXPECT_NEAR(force(stuck, lagged(stuck, stuck, next))[0], sticks[0], 1e-12 * normal);
  }
  const std::vector<double> slid = halves_.moved(-0.1, 0.3, 0.0),
                            further = halves_.moved(-0.1, 0.4, 0.0);
  History now = lagged(pressed, slid, history);
  double expected = 0.0;  // at the ends of the faces the normals lean
  for (const Slip& slip : now.slips(Rub::faces)) {
    const double leans = slip.normal[0];
    expected -= coefficient * slip.normal_force * std::sqrt(1.0 - leans * leans);
  }
  EXPECT_LT(expected, -0.3 * normal);
  EXPECT_NEAR(force(slid, now)[0] - force(slid, {})[0], expected, 1e-9 * normal);
  static_cast<void>(assembler_.commit(slid, now));
  History last = lagged(slid, further, now);
  const double held = force(further, last)[0] - force(further, {})[0];
  EXPECT_NEAR(assembler_.commit(further, last).released, -held * 0.1 * spacing,
              0.02 * normal * spacing);
}

std::string name_of(const ::testing::TestParamInfo<Rubs>& info) {
  return std::string(info.param.has_faces ? "Faces" : "Points") +
         std::to_string(info.param.dimension) + "D";
}
INSTANTIATE_TEST_SUITE_P(Kinds, PointFrictionOf,
                         ::testing::Values(Rubs{true, 2}, Rubs{true, 3}, Rubs{false, 2},
                                           Rubs{false, 3}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Kinds, FaceFriction, ::testing::Values(Rubs{true, 2}, Rubs{true, 3}),
                         name_of);

}  // namespace
}  // namespace peristat
