// Statements that hold for every potential, written once.
#include "src/potentials/potential.hpp"

#include <cmath>
#include <limits>
#include <variant>

#include <gtest/gtest.h>

#include "tests/finite_differences.hpp"

namespace peristat {
namespace {

/// One member of each potential with constants of order one; a new potential adds its own.
template <class P>
P example();
template <>
Harmonic example<Harmonic>() {
  return {1.7};
}

/// Of bonds, and of triangles and tetrahedra; Harmonic is both.
template <class Bonds, class Higher>
struct TypesOf;
template <class... Whole, class... Higher>
struct TypesOf<BondPotentials<Whole...>, std::variant<Harmonic, Higher...>> {
  using type = ::testing::Types<Whole..., Higher...>;
};

constexpr double relative_changes[] = {-0.3, -0.011, 1e-3, 0.02, 0.4};

template <class P>
class EveryPotential : public ::testing::Test {
 protected:
  static_assert(Potential<P>);
  const P potential_ = example<P>();
};
using Potentials = TypesOf<WholeBondPotentials, HigherPotential>::type;
TYPED_TEST_SUITE(EveryPotential, Potentials);

TYPED_TEST(EveryPotential, FirstIsDerivativeOfValue) {
  for (double e : relative_changes) {
    const auto value = [&](double t) { return std::vector<double>{this->potential_(e + t).value}; };
    EXPECT_TRUE(tests::is_derivative(value, {this->potential_(e).first}, 1e-4)) << "at " << e;
  }
}

TYPED_TEST(EveryPotential, SecondIsDerivativeOfFirst) {
  for (double e : relative_changes) {
    const auto first = [&](double t) { return std::vector<double>{this->potential_(e + t).first}; };
    EXPECT_TRUE(tests::is_derivative(first, {this->potential_(e).second}, 1e-4)) << "at " << e;
  }
}

TYPED_TEST(EveryPotential, IsStressFreeAtReference) {
  const auto reference = this->potential_(0.0);
  EXPECT_EQ(reference.value, 0.0);
  EXPECT_EQ(reference.first, 0.0);
  EXPECT_EQ(reference.second, this->potential_.modulus);  // which constants of materials go by
  EXPECT_GT(this->potential_(1e-3).first, 0.0);
  EXPECT_LT(this->potential_(-1e-3).first, 0.0);
}

TYPED_TEST(EveryPotential, LanesAgreeWithDoublesLaneByLane) {
  const Lanes e([](int l) { return relative_changes[l]; });
  const auto lanes = this->potential_(e);
  for (int l = 0; l < lane_count; ++l) {
    const auto single = this->potential_(relative_changes[l]);
    constexpr double tolerance = 4 * std::numeric_limits<double>::epsilon();
    EXPECT_NEAR(lanes.value[l], single.value, tolerance);
    EXPECT_NEAR(lanes.first[l], single.first, tolerance);
    EXPECT_NEAR(lanes.second[l], single.second, tolerance);
  }
}

TEST(HarmonicPotential, IsQuadraticInTheRelativeChange) {
  const Harmonic potential{4.0};
  EXPECT_DOUBLE_EQ(potential(0.5).value, 0.5 * 4.0 * 0.25);
  EXPECT_DOUBLE_EQ(potential(-0.5).first, -2.0);
  EXPECT_DOUBLE_EQ(potential(0.5).second, 4.0);
}

}  // namespace
}  // namespace peristat
