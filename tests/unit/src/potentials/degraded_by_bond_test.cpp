#include <gtest/gtest.h>

#include "src/potentials/degraded.hpp"

namespace peristat {
namespace {

/// Potentials of bonds of two laws in turn, each with stretches of its own.
struct Mixed {
  static constexpr Offset bonds = 11;
  std::shared_ptr<BondLaws> laws = std::make_shared<BondLaws>(
      std::vector<AnyBondLaw>{{CriticalStretch{9.0}}, {TanhDegradation::continuous(1.0, 2.0, 4.0)}},
      std::size_t(bonds));

  Mixed() {
    for (Offset bond = 0; bond < bonds; ++bond) {
      laws->set(bond, std::size_t(bond % 2), onset(bond), critical(bond));
    }
  }
  static double onset(Offset bond) {
    return bond % 2 ? 0.01 + 0.001 * double(bond) : critical(bond);
  }
  static double critical(Offset bond) { return 0.03 + 0.002 * double(bond); }

  /// What a body of one law has.
  static PotentialDensity<double> expected(Offset bond, double s, double history, bool held) {
    if (bond % 2 == 0) {
      return Degraded<CriticalStretch>{5.0, {critical(bond)}, Harmonic{1.0}, held}(s, history);
    }
    return Degraded<TanhDegradation>{5.0,
                                     TanhDegradation::continuous(onset(bond), critical(bond), 4.0),
                                     Harmonic{1.0}, held}(s, history);
  }
};

TEST(DegradedByBond, IsDegradedByEachBondsLaw) {
  const Mixed mixed;
  int softened = 0;
  for (const bool held : {false, true}) {
    DegradedByBond<Harmonic> potential{5.0, mixed.laws};
    potential.holds_damage = held;
    for (Offset bond = 0; bond < Mixed::bonds; ++bond) {
      for (const double s : {-0.02, 0.005, 0.012, 0.025, 0.04, 0.06}) {
        for (const double history : {never_failing, 0.0, 0.02, 0.035, 0.09}) {
          const auto found = potential.of_bond(bond)(s, history);
          const auto expected = Mixed::expected(bond, s, history, held);
          EXPECT_DOUBLE_EQ(found.value, expected.value);
          EXPECT_DOUBLE_EQ(found.first, expected.first);
          EXPECT_DOUBLE_EQ(found.second, expected.second);
          softened += found.first != 5.0 * s && found.first != 0.0;
        }
      }
    }
  }
  EXPECT_GT(softened, 20);
}

TEST(BondLaws, ScaleAnEnvelopeAsAWhole) {
  BondLaws laws({{ForceEnvelope{1.0, 3.0, 2.0, 0.25, 0.5}}}, 1);
  laws.set(0, 0, 0.01, 0.03);
  const auto law = std::get<ForceEnvelope>(laws.at(0).law);
  EXPECT_DOUBLE_EQ(law.peak(), 0.015);
  EXPECT_DOUBLE_EQ(law.peak_force(), 0.0125);
  EXPECT_EQ(law.decay, 2.0);
}

TEST(DegradedByBond, IsTheSameOverLanes) {
  const Mixed mixed;
  const DegradedByBond<Harmonic> potential{5.0, mixed.laws};
  for (Offset first = 0; first < Mixed::bonds; ++first) {  // past the last bond, too
    for (const double size : {0.2, 1.0, 2.0}) {
      const Lanes s([&](int l) { return size * (0.01 + 0.007 * l); });
      const Lanes history([](int l) { return l == 1 ? 0.0 : l == 2 ? never_failing : 0.02 * l; });
      const auto batch = potential(s, history, first);
      for (int l = 0; l < lane_count; ++l) {
        const auto one = potential.of_bond(first + l)(double(s[l]), double(history[l]));
        EXPECT_EQ(batch.value[l], one.value);
        EXPECT_EQ(batch.first[l], one.first);
        EXPECT_EQ(batch.second[l], one.second);
      }
    }
  }
}

}  // namespace
}  // namespace peristat
