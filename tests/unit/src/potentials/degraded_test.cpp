// Statements that hold for every law of degradation, written once, and closed forms of each.
#include "src/potentials/degraded.hpp"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "src/potentials/potential.hpp"
#include "tests/finite_differences.hpp"

namespace peristat {
namespace {

constexpr double onset = 0.016, critical = 0.02;

/// A potential of whole bonds that no law of damage knows: phi = C (e^2/2 + 10 e^3).
struct Stiffening {
  static constexpr const char* name = "stiffening";
  double modulus = 0.0;
  template <class Real>
  [[nodiscard]] PotentialDensity<Real> operator()(const Real& e) const {
    return {modulus * e * e * (0.5 + 10.0 * e), modulus * e * (1.0 + 30.0 * e),
            modulus * (1.0 + 60.0 * e)};
  }
};
static_assert(Potential<Stiffening>);

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

template <>
ForceEnvelope example<ForceEnvelope>() {
  return {onset, critical, 2.0, 0.3, 0.4};
}

/// A force that rises on a lower slope, falls in two parts, and jumps to zero at the end.
const std::vector<double> stretches_of_table{onset, 0.017, 0.019, critical},
    forces_of_table{onset, 0.0163, 0.012, 0.004};

ForceTable table_of(const std::vector<double>& stretches, const std::vector<double>& forces) {
  return {std::make_shared<const ForceCurve>(stretches, forces), stretches.back()};
}

template <>
ForceTable example<ForceTable>() {
  return table_of(stretches_of_table, forces_of_table);
}

struct Bilinear : OpeningLaw {};
struct Cornelissen : OpeningLaw {};
/// An onset that lets a bond open without a snap-back.
constexpr double early = 0.002;
template <>
Bilinear example<Bilinear>() {
  return {{early, critical, OpeningCurve::bilinear}};
}
template <>
Cornelissen example<Cornelissen>() {
  return {{early, critical, OpeningCurve::cornelissen}};
}

/// Numerical integral of T phi_0' from a to b by the composite midpoint rule with Richardson's
/// extrapolation; neither end nor the points meet a jump of T, nor cells a kink.
template <class Law, class Whole = Harmonic>
double work_between(const Law& law, double a, double b, const Whole& whole = {1.0}) {
  if constexpr (requires { law.peak(); }) {
    const double kink = law.peak();
    if (a < kink && kink < b)
      return work_between(law, a, kink, whole) + work_between(law, kink, b, whole);
  }
  if constexpr (requires { law.stretch_at(kink_of_bilinear); }) {
    const double kink = law.stretch_at(kink_of_bilinear);
    if (a * (1.0 + 1e-12) < kink && kink < b * (1.0 - 1e-12))
      return work_between(law, a, kink, whole) + work_between(law, kink, b, whole);
  }
  if constexpr (requires { law.curve->knots(); }) {
    for (const ForceCurve::Knot& knot : law.curve->knots()) {
      const double kink = knot.stretch * law.critical();
      if (a * (1.0 + 1e-12) < kink && kink < b * (1.0 - 1e-12))
        return work_between(law, a, kink, whole) + work_between(law, kink, b, whole);
    }
  }
  const auto midpoint = [&](int cells) {
    double sum = 0.0;
    for (int k = 0; k < cells; ++k) {
      const double r = a + (b - a) * (k + 0.5) / cells;
      sum += whole(r).first * law.integrity(r);
    }
    return sum * (b - a) / cells;
  };
  return (4.0 * midpoint(40000) - midpoint(20000)) / 3.0;
}

template <class Potential>
class EveryDegradation;

template <class Law, class Whole>
class EveryDegradation<Degraded<Law, Whole>> : public ::testing::Test {
 protected:
  const Degraded<Law, Whole> potential_{2.5e3, example<Law>()};
  const Whole whole_{2.5e3};
  /// Histories without, with some and with complete damage, and a bond that never fails.
  const std::vector<double> histories_{
      0.0, 0.5 * onset, 0.0175, 0.999 * critical, 1.1 * critical, Degraded<Law>::never_fails};
};
using Degradations =
    ::testing::Types<Degraded<CriticalStretch>, Degraded<TanhDegradation>, Degraded<ForceEnvelope>,
                     Degraded<ForceTable>, Degraded<Bilinear>, Degraded<Cornelissen>,
                     Degraded<CriticalStretch, Stiffening>, Degraded<TanhDegradation, Stiffening>,
                     Degraded<ForceEnvelope, Stiffening>, Degraded<Cornelissen, Stiffening>>;
TYPED_TEST_SUITE(EveryDegradation, Degradations);

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
        this->whole_(elastic).value + work_between(law, elastic, e, this->whole_);
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
  EXPECT_EQ(this->potential_.dissipated(0.9 * this->potential_.law.onset()), 0.0);
}

TYPED_TEST(EveryDegradation, UnloadsAlongTheSecantAndReloadsAlongIt) {
  const double kappa = 0.0183;
  const double integrity = this->potential_.law.integrity(kappa);
  for (const double e : {-0.01, 1e-5, 0.01, kappa}) {
    const auto at = this->potential_(e, kappa), whole = this->whole_(e);
    EXPECT_DOUBLE_EQ(at.first, integrity * whole.first);
    EXPECT_DOUBLE_EQ(at.second, integrity * whole.second);
    EXPECT_DOUBLE_EQ(at.value, integrity * whole.value);
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

TYPED_TEST(EveryDegradation, BondsThatCloseLoseTensionAlone) {
  TypeParam closing = this->potential_;
  closing.closes = true;
  const double stretches[] = {-0.01, 0.017, -1e-9, 0.03};
  for (const double kappa : this->histories_) {
    const auto lanes = closing(Lanes([&](int l) { return stretches[l]; }), Lanes(kappa));
    for (int l = 0; l < lane_count; ++l) {
      const double e = stretches[l];
      const auto expected = e < 0.0 ? this->whole_(e) : this->potential_(e, kappa);
      const auto single = closing(e, kappa);
      EXPECT_DOUBLE_EQ(single.value, expected.value);
      EXPECT_DOUBLE_EQ(single.first, expected.first);
      EXPECT_DOUBLE_EQ(single.second, expected.second);
      EXPECT_DOUBLE_EQ(lanes.value[l], expected.value);
      EXPECT_DOUBLE_EQ(lanes.first[l], expected.first);
      EXPECT_DOUBLE_EQ(lanes.second[l], expected.second);
    }
    EXPECT_EQ(closing.dissipated(kappa), this->potential_.dissipated(kappa));
  }
}

TYPED_TEST(EveryDegradation, ABondThatNeverFailsStaysWhole) {
  const double kappa = TypeParam::never_fails;
  for (const double e : {-0.1, 0.01, 0.018, 0.5}) {
    EXPECT_DOUBLE_EQ(this->potential_(e, kappa).first, this->whole_(e).first);
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

TEST(TanhDegradation, WorkIsTheIntegralAtEveryRate) {
  for (const double rate : {0.1, 1.0, 3.0, 20.0}) {
    for (const TanhDegradation& law : {TanhDegradation{onset, critical, rate},
                                       TanhDegradation::continuous(onset, critical, rate)}) {
      for (const double s : {0.0161, 0.018, 0.01999}) {
        const double beyond = work_between(law, onset, s);
        // 1e-10: midpoint cells resolve the steepest law to that.
        EXPECT_NEAR((law.work(Harmonic{1.0}, s) - law.work(Harmonic{1.0}, onset)) / beyond, 1.0,
                    1e-10)
            << rate << ", " << s;
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

/// Laws whose force falls from the onset on, with every sort of tail, and one that rises first.
const std::vector<ForceEnvelope> envelopes{{onset, critical},
                                           {onset, critical, 0.1},
                                           {onset, critical, 3.0},
                                           {onset, critical, 50.0},
                                           {onset, critical, 0.0, 0.5, 0.25},
                                           {0.1 * onset, critical, 5.0, 0.9, 0.99}};

TEST(ForceEnvelope, FallsLinearlyAndTakesHalfOfOnsetTimesCritical) {
  const ForceEnvelope law{onset, critical};
  for (const double x : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const double s = onset + x * (critical - onset);
    EXPECT_NEAR(s * law.integrity(s), onset * (1.0 - x), 1e-15) << x;
  }
  EXPECT_NEAR(law.work(Harmonic{1.0}, critical) / (0.5 * onset * critical), 1.0, 1e-14);
  EXPECT_EQ(law.peak_force(), onset);
}

TEST(ForceEnvelope, FallsExponentially) {
  const ForceEnvelope law{onset, critical, 3.0};
  for (const double x : {0.1, 0.5, 0.9}) {
    const double s = onset + x * (critical - onset);
    const double expected = (std::exp(-3.0 * x) - std::exp(-3.0)) / (1.0 - std::exp(-3.0));
    EXPECT_NEAR(s * law.integrity(s) / onset, expected, 1e-14) << x;
  }
}

TEST(ForceEnvelope, TendsToTheLinearLawAsTheDecayVanishes) {
  const ForceEnvelope linear{onset, critical}, nearly{onset, critical, 1e-6};
  for (const double s : {0.0165, 0.018, 0.0199, critical}) {
    EXPECT_NEAR(nearly.integrity(s), linear.integrity(s), 1e-6);
    const double work = linear.work(Harmonic{1.0}, s);
    EXPECT_NEAR(nearly.work(Harmonic{1.0}, s) / work, 1.0, 1e-6);
  }
}

TEST(ForceEnvelope, RisesOnTheLowerSlopeToItsPeak) {
  const ForceEnvelope law{onset, critical, 0.0, 0.5, 0.25};
  EXPECT_DOUBLE_EQ(law.peak(), 0.018);
  EXPECT_DOUBLE_EQ(law.peak_force(), 0.0165);
  EXPECT_NEAR(0.017 * law.integrity(0.017), 0.01625, 1e-16);
  EXPECT_NEAR(0.019 * law.integrity(0.019), 0.00825, 1e-16);
  for (const double s : {0.0165, 0.0175, 0.0185, 0.0195}) {
    EXPECT_LE(s * law.integrity(s), law.peak_force());
  }
}

TEST(ForceEnvelope, WorkIsTheIntegralUpToEveryStretch) {
  for (const ForceEnvelope& law : envelopes) {
    // Between the kinks at onset, peak and critical stretch, where the midpoint rule converges.
    double sum = 0.5 * law.onset() * law.onset(), before = law.onset();
    for (const double s : {law.peak(), 0.5 * (law.peak() + critical), critical}) {
      if (s > before) sum += work_between(law, before, s);
      before = s;
      // 1e-11: what Richardson's rule leaves of the steepest tail.
      EXPECT_NEAR(law.work(Harmonic{1.0}, s) / sum, 1.0, 1e-11) << law.decay << " to " << s;
    }
    EXPECT_EQ(law.work(Harmonic{1.0}, 2.0 * critical), law.work(Harmonic{1.0}, critical));
  }
}

TEST(ForceEnvelope, NeverJumpsAndLosesIntegrityAllTheWay) {
  for (const ForceEnvelope& law : envelopes) {
    for (const double s : {law.onset(), law.peak(), critical}) {
      const double before = s * (1.0 - 1e-12), after = s * (1.0 + 1e-12);
      EXPECT_NEAR(before * law.integrity(before), after * law.integrity(after), 1e-11) << s;
    }
    double last = 1.0;
    for (int k = 1; k < 100; ++k) {
      const double now = law.integrity(law.onset() + (critical - law.onset()) * k / 100.0);
      EXPECT_LT(now, last);
      last = now;
    }
  }
}

TEST(ForceTable, GoesThroughItsPairs) {
  const ForceTable law = example<ForceTable>();
  for (std::size_t k = 0; k + 1 < stretches_of_table.size(); ++k) {
    const double s = stretches_of_table[k], t = stretches_of_table[k + 1];
    EXPECT_NEAR(s * law.integrity(s), forces_of_table[k], 1e-16);
    EXPECT_NEAR(0.5 * (s + t) * law.integrity(0.5 * (s + t)),
                0.5 * (forces_of_table[k] + forces_of_table[k + 1]), 1e-16);
  }
  const double last = std::nextafter(critical, 0.0);
  EXPECT_NEAR(last * law.integrity(last), 0.004, 1e-12) << "the force jumps at the end";
  EXPECT_EQ(law.integrity(critical), 0.0);
  EXPECT_EQ(law.onset(), onset);
  EXPECT_DOUBLE_EQ(law.peak_force(), 0.0163);
  // Trapezoids.
  EXPECT_NEAR(law.work(Harmonic{1.0}, critical),
              0.5 * onset * onset + 0.5e-3 * 0.0323 + 1e-3 * 0.0283 + 0.5e-3 * 0.016, 1e-17);
  EXPECT_EQ(law.work(Harmonic{1.0}, 2.0 * critical), law.work(Harmonic{1.0}, critical));
}

TEST(ForceTable, OfTwoPairsIsTheLinearLaw) {
  const ForceEnvelope linear{onset, critical};
  const ForceTable table = table_of({onset, critical}, {onset, 0.0});
  for (const double kappa : {0.0, 0.0165, 0.019}) {
    for (int k = 1; k < 200; ++k) {
      const double s = 1.2 * critical * k / 200.0;
      const auto a = Degraded<ForceEnvelope>{2.0, linear}(s, kappa);
      const auto b = Degraded<ForceTable>{2.0, table}(s, kappa);
      EXPECT_NEAR(a.value, b.value, 1e-15 * onset);
      EXPECT_NEAR(a.first, b.first, 1e-14 * onset);
      EXPECT_NEAR(a.second, b.second, 1e-12);
    }
  }
}

TEST(ForceTable, IsElasticUpToTheLastPairOfTheElasticPart) {
  const ForceTable law = table_of({0.01, 0.012, 0.02}, {0.01, 0.012 * (1.0 - 1e-7), 0.0});
  EXPECT_DOUBLE_EQ(law.onset(), 0.012);
  EXPECT_EQ(law.integrity(0.012), 1.0);
  EXPECT_LT(law.integrity(0.0121), 1.0);
}

TEST(ForceTable, KeepsItsFormBetweenOtherStretches) {
  const ForceTable law = example<ForceTable>(), twice = law.between(2.0 * onset, 2.0 * critical);
  for (const double s : {0.0165, 0.0183, 0.0199}) {
    EXPECT_DOUBLE_EQ(twice.integrity(2.0 * s), law.integrity(s));
    EXPECT_NEAR(2.0 * twice.slope(2.0 * s) / law.slope(s), 1.0, 1e-12);
  }
}

/// The curves as published, over the opening w with f_t = 1 and w_c = 1.
double petersson(double w) { return w < 0.8 / 3.6 ? 1.0 - w * 3.6 / 1.2 : (1.0 - w) * 3.0 / 7.0; }
double cornelissen(double w) {
  return (1.0 + std::pow(3.0 * w, 3)) * std::exp(-6.93 * w) - w * 28.0 * std::exp(-6.93);
}

const std::vector<std::pair<OpeningCurve, double (*)(double)>> opening_curves{
    {OpeningCurve::bilinear, petersson}, {OpeningCurve::cornelissen, cornelissen}};

TEST(OpeningLaw, FollowsItsCurveOverTheOpening) {
  for (const auto& [curve, published] : opening_curves) {
    for (const double ratio : {1e-6, 0.01, 0.1, largest_onset_of(curve) * (1.0 - 1e-9)}) {
      const OpeningLaw law{ratio * critical, critical, curve};
      double last = 1.0;
      for (int k = 1; k < 200; ++k) {
        const double w = k / 200.0, force = law.onset() * published(w);
        const double s = force + w * critical;
        EXPECT_NEAR(law.stretch_at(w), s, 1e-16);
        // 1e-6: at 1e-9 from the limit the stretch hardly grows with the opening.
        EXPECT_NEAR(s * law.integrity(s), force, (ratio < 0.12 ? 1e-13 : 1e-6) * law.onset()) << w;
        EXPECT_LT(law.integrity(s), last);
        last = law.integrity(s);
      }
      for (const double s : {law.onset(), critical}) {
        const double before = s * (1.0 - 1e-12), after = s * (1.0 + 1e-12);
        // At 1e-9 from the limit the force falls with a slope of 1e9.
        EXPECT_NEAR(before * law.integrity(before), after * law.integrity(after),
                    (ratio < 0.12 ? 1e-10 : 1e-2) * law.onset());
      }
    }
  }
}

/// The work of the whole bond is the area below the curve of the opening: G_F = f_t w_c / 3.6 and
/// f_t w_c / 5.136.
TEST(OpeningLaw, TakesTheAreaBelowItsCurve) {
  for (const auto& [curve, area, digits] :
       {std::tuple(OpeningCurve::bilinear, 1.0 / 3.6, 1e-14),
        std::tuple(OpeningCurve::cornelissen, 1.0 / 5.136, 1e-4)}) {
    for (const double share : {0.01, 0.5, 0.999}) {
      const OpeningLaw law{share * largest_onset_of(curve) * critical, critical, curve};
      const double work = law.work(Harmonic{1.0}, critical);
      EXPECT_NEAR(work / (area * law.onset() * critical), 1.0, digits);
      EXPECT_EQ(law.work(Harmonic{1.0}, 2.0 * critical), work);
      const double elastic = 0.5 * law.onset() * law.onset();
      if (share < 0.9) {
        EXPECT_NEAR((elastic + work_between(law, law.onset(), critical)) / work, 1.0, 1e-9);
      }
    }
  }
  EXPECT_NEAR(largest_onset_of(OpeningCurve::bilinear), 1.0 / 3.0, 1e-16);
  EXPECT_NEAR(largest_onset_of(OpeningCurve::cornelissen), 0.1437, 5e-5);
}

TEST(OpeningLaw, OfTwoLinesIsATableOfThreePairs) {
  const double third = early / 3.0;
  const OpeningLaw law{early, critical, OpeningCurve::bilinear};
  const ForceTable table =
      table_of({early, third + 2.0 / 9.0 * critical, critical}, {early, third, 0.0});
  for (const double kappa : {0.0, 0.003, 0.011}) {
    for (int k = 1; k < 200; ++k) {
      const double s = 1.2 * critical * k / 200.0;
      const auto a = Degraded<OpeningLaw>{2.0, law}(s, kappa);
      const auto b = Degraded<ForceTable>{2.0, table}(s, kappa);
      EXPECT_NEAR(a.value, b.value, 1e-15 * early);
      EXPECT_NEAR(a.first, b.first, 1e-14 * early);
      EXPECT_NEAR(a.second, b.second, 1e-12);
    }
  }
}

TEST(Degraded, ContinuousFormHasNoJumpOfForce) {
  const Degraded<TanhDegradation> potential{1.0, TanhDegradation::continuous(onset, critical, 3.0)};
  for (const double s : {onset, critical}) {
    EXPECT_NEAR(potential(s * (1 + 1e-11), 0.0).first, potential(s * (1 - 1e-11), 0.0).first, 1e-9);
  }
}

}  // namespace
}  // namespace peristat
