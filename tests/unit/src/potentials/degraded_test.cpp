// Statements that hold for every law of degradation, written once, and closed forms of each.
#include "src/potentials/degraded.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "src/potentials/potential.hpp"
#include "tests/finite_differences.hpp"

namespace peristat {
namespace {

constexpr double onset = 0.016, critical = 0.02;

template <class Law>
Law example();
template <>
CriticalStretch example<CriticalStretch>() {
  return {critical};
}
template <>
TanhDegradation example<TanhDegradation>() {
  return {onset, critical, 3.0};
}

/// Numerical integral of r T(r) from a to b by the composite midpoint rule with Richardson's
/// extrapolation; neither end nor the points meet a jump of T.
template <class Law>
double integral(const Law& law, double a, double b) {
  const auto midpoint = [&](int cells) {
    double sum = 0.0;
    for (int k = 0; k < cells; ++k) {
      const double r = a + (b - a) * (k + 0.5) / cells;
      sum += r * law.integrity(r);
    }
    return sum * (b - a) / cells;
  };
  return (4.0 * midpoint(40000) - midpoint(20000)) / 3.0;
}

template <class Law>
class EveryDegradation : public ::testing::Test {
 protected:
  const Degraded<Law> potential_{2.5e3, example<Law>()};
  /// Histories without, with some and with complete damage, and a bond that never fails.
  const std::vector<double> histories_{
      0.0, 0.5 * onset, 0.0175, 0.999 * critical, 1.1 * critical, Degraded<Law>::never_fails};
};
using Laws = ::testing::Types<CriticalStretch, TanhDegradation>;
TYPED_TEST_SUITE(EveryDegradation, Laws);

TYPED_TEST(EveryDegradation, FirstIsDerivativeOfValueInLoadingAndUnloading) {
  int checked = 0;
  for (const double kappa : this->histories_) {
    // Away from the kinks at the onset, at the history and at the critical stretch.
    for (const double e : {-0.1, -0.003, 0.004, 0.0165, 0.0183, 0.0194, 0.05}) {
      const auto at = this->potential_(e, kappa);
      if (at.first == 0.0) continue;  // broken
      const auto value = [&](double t) {
        return std::vector<double>{this->potential_(e + t, kappa).value};
      };
      EXPECT_TRUE(tests::is_derivative(value, {at.first}, 2e-6)) << e << " after " << kappa;
      ++checked;
    }
  }
  EXPECT_GT(checked, 20);
}

TYPED_TEST(EveryDegradation, SecondIsDerivativeOfFirstInLoadingAndUnloading) {
  int checked = 0;
  for (const double kappa : this->histories_) {
    for (const double e : {-0.1, -0.003, 0.004, 0.0165, 0.0183, 0.0194, 0.05}) {
      const auto at = this->potential_(e, kappa);
      if (at.first == 0.0) continue;
      const auto first = [&](double t) {
        return std::vector<double>{this->potential_(e + t, kappa).first};
      };
      EXPECT_TRUE(tests::is_derivative(first, {at.second}, 2e-6)) << e << " after " << kappa;
      ++checked;
    }
  }
  EXPECT_GT(checked, 20);
}

TYPED_TEST(EveryDegradation, LanesAgreeWithDoublesLaneByLane) {
  const double stretches[] = {-0.01, 0.017, 0.0185, 0.03};
  for (const double kappa : this->histories_) {
    const Lanes e([&](int l) { return stretches[l]; });
    const auto lanes = this->potential_(e, Lanes(kappa));
    for (int l = 0; l < lane_count; ++l) {
      const auto single = this->potential_(stretches[l], kappa);
      EXPECT_DOUBLE_EQ(lanes.value[l], single.value);
      EXPECT_DOUBLE_EQ(lanes.first[l], single.first);
      EXPECT_DOUBLE_EQ(lanes.second[l], single.second);
    }
  }
}

TYPED_TEST(EveryDegradation, EnergyIsTheWorkOfTheForce) {
  const auto& law = this->potential_.law;
  for (const double e : {0.004, 0.0165, 0.0183, 0.0199}) {
    const double elastic = std::min(e, law.onset());
    const double expected =
        this->potential_.modulus * (0.5 * elastic * elastic + integral(law, elastic, e));
    // 1e-12: what Richardson's rule leaves with these cells.
    EXPECT_NEAR(this->potential_(e, 0.0).value / expected, 1.0, 1e-12) << e;
  }
}

TYPED_TEST(EveryDegradation, WhatIsStoredAndDissipatedIsWhatWasTakenUp) {
  for (const double e : {0.004, 0.0165, 0.0183, 0.0199, 0.04}) {
    const double taken_up = this->potential_(e, 0.0).value;
    const double stored = this->potential_(e, e).value;
    EXPECT_NEAR((stored + this->potential_.dissipated(e)) / taken_up, 1.0, 1e-12) << e;
    EXPECT_GE(this->potential_.dissipated(e), 0.0);
  }
  EXPECT_GT(this->potential_.dissipated(0.04), 0.0);
  EXPECT_EQ(this->potential_.dissipated(0.9 * onset), 0.0);
}

TYPED_TEST(EveryDegradation, UnloadsAlongTheSecantAndReloadsAlongIt) {
  const double kappa = 0.0183;
  const double secant = this->potential_.modulus * this->potential_.law.integrity(kappa);
  for (const double e : {-0.01, 1e-5, 0.01, kappa}) {
    const auto at = this->potential_(e, kappa);
    EXPECT_DOUBLE_EQ(at.first, secant * e);
    EXPECT_DOUBLE_EQ(at.second, secant);
    EXPECT_DOUBLE_EQ(at.value, 0.5 * secant * e * e);
  }
}

TYPED_TEST(EveryDegradation, BrokenStaysBroken) {
  for (const double e : {-0.1, 0.0, 0.01, 0.05}) {
    const auto at = this->potential_(e, critical);
    EXPECT_EQ(at.value, 0.0);
    EXPECT_EQ(at.first, 0.0);
    EXPECT_EQ(at.second, 0.0);
    EXPECT_FALSE(this->potential_.is_loading(e, critical));
  }
  EXPECT_TRUE(this->potential_.is_broken(critical));
  EXPECT_FALSE(this->potential_.is_broken(std::nextafter(critical, 0.0)));
}

TYPED_TEST(EveryDegradation, ABondThatNeverFailsIsHarmonic) {
  const double kappa = Degraded<TypeParam>::never_fails;
  for (const double e : {-0.1, 0.01, 0.018, 0.5}) {
    EXPECT_DOUBLE_EQ(this->potential_(e, kappa).first, this->potential_.modulus * e);
    EXPECT_FALSE(this->potential_.is_loading(e, kappa));
  }
  EXPECT_EQ(this->potential_.dissipated(kappa), 0.0);
}

TEST(TanhDegradation, JumpsAsPublishedAndNotInItsContinuousForm) {
  // (1 - tanh 3)/2 = 0.0024726 at both ends ([ADAPT] eq. 12).
  const double jump = 0.5 * (1.0 - std::tanh(3.0));
  const TanhDegradation published{onset, critical, 3.0};
  EXPECT_NEAR(published.integrity(onset * (1.0 + 1e-12)), 1.0 - jump, 1e-9);
  EXPECT_NEAR(published.integrity(critical * (1.0 - 1e-12)), jump, 1e-9);
  const TanhDegradation continuous = TanhDegradation::continuous(onset, critical, 3.0);
  EXPECT_NEAR(continuous.integrity(onset * (1.0 + 1e-12)), 1.0, 1e-9);
  EXPECT_NEAR(continuous.integrity(critical * (1.0 - 1e-12)), 0.0, 1e-9);
  for (const TanhDegradation& law : {published, continuous}) {
    EXPECT_EQ(law.integrity(onset), 1.0);
    EXPECT_EQ(law.integrity(critical), 0.0);
    EXPECT_NEAR(law.integrity(0.5 * (onset + critical)), 0.5, 1e-14);
  }
}

TEST(TanhDegradation, MomentIsTheIntegralAtEveryRate) {
  for (const double rate : {0.1, 1.0, 3.0, 20.0}) {
    for (const TanhDegradation& law : {TanhDegradation{onset, critical, rate},
                                       TanhDegradation::continuous(onset, critical, rate)}) {
      for (const double s : {0.0161, 0.018, 0.01999}) {
        const double beyond = integral(law, onset, s);
        // 1e-10: midpoint cells resolve the steepest law to that.
        EXPECT_NEAR((law.moment(s) - law.moment(onset)) / beyond, 1.0, 1e-10) << rate << ", " << s;
      }
    }
  }
}

TEST(TanhDegradation, TangentIsStronglyNegativeInTheMiddle) {
  // phi"/c = T + s T' with T = 1/2 and
  // T' = -beta/(s_c - s_m), 1/2 - 0.018 * 3/0.004 = -13.
  const Degraded<TanhDegradation> potential{1.0, {onset, critical, 3.0}};
  EXPECT_NEAR(potential(0.018, 0.0).second, -13.0, 1e-12);
}

TEST(Degraded, ContinuousFormHasNoJumpOfForce) {
  const Degraded<TanhDegradation> potential{1.0, TanhDegradation::continuous(onset, critical, 3.0)};
  for (const double s : {onset, critical}) {
    EXPECT_NEAR(potential(s * (1 + 1e-11), 0.0).first, potential(s * (1 - 1e-11), 0.0).first, 1e-9);
  }
}

}  // namespace
}  // namespace peristat
