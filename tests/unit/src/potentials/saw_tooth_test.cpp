#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "src/potentials/make_saw_tooth.hpp"

namespace peristat {
namespace {

struct Named {
  const char* name;
  AnyBondLaw law;
};

const Named laws[] = {
    {"tanh", {TanhDegradation{0.015, 0.02, 3.0}}},
    {"continuous", {TanhDegradation::continuous(0.01, 0.03, 2.0)}},
    {"linear", {ForceEnvelope{0.01, 0.04}}},
    {"exponential", {ForceEnvelope{0.01, 0.08, 5.0}}},
    {"blended", {ForceEnvelope{0.01, 0.05, 0.0, 0.3, 0.4}}},
    {"bilinear", {OpeningLaw{0.01, 0.05, OpeningCurve::bilinear}}},
    {"cornelissen", {OpeningLaw{0.01, 0.08, OpeningCurve::cornelissen}}},
    {"table",
     {ForceTable{std::make_shared<const ForceCurve>(std::vector{0.01, 0.015, 0.03, 0.05},
                                                    std::vector{0.01, 0.012, 0.004, 0.001}),
                 0.05}}}};

const SawTooth& teeth_of(const AnyBondLaw& law) { return std::get<SawTooth>(law.law); }

double force(const AnyBondLaw& law, double s) { return law.integrity(s) * s; }

double largest_force(const AnyBondLaw& law) {
  double largest = 0.0;
  for (int k = 0; k <= 2000; ++k) {
    largest = std::max(largest, force(law, law.critical() * k / 2000.0));
  }
  return largest;
}

TEST(SawTooth, EveryDropDissipatesWhatTheLawDoes) {
  for (const auto& [name, law] : laws) {
    for (const int most : {1, 3, 20, 80}) {
      SCOPED_TRACE(std::string(name) + ", " + std::to_string(most));
      const AnyBondLaw toothed = saw_tooth(law, most);
      const Degraded<AnyBondLaw> smooth{2.0, law}, saw{2.0, toothed};
      EXPECT_NEAR(saw.dissipated(toothed.critical()), smooth.dissipated(law.critical()),
                  1e-8 * smooth.dissipated(law.critical()));
      // Drop by drop: force times stretch over the drops, by hand.
      double by_hand = 0.0, borne = saw.borne(0.0);
      int drops = 0;
      for (double history = 0.0; !saw.is_broken(history); ++drops) {
        borne = saw.borne(history);
        const double next = toothed.borne_after(borne);
        by_hand +=
            0.5 * 2.0 * borne * borne * (saw.integrity_after(history) - saw.integrity_after(next));
        EXPECT_NEAR(saw.dissipated(next), by_hand, 1e-12 * by_hand);
        history = next;
      }
      EXPECT_NEAR(by_hand, smooth.dissipated(law.critical()), 1e-8 * by_hand);
      EXPECT_LE(drops, most);
      EXPECT_GE(drops, most > 1 ? most - 1 : 1);
    }
  }
}

TEST(SawTooth, StaysWithinTheBandThatItTells) {
  for (const auto& [name, law] : laws) {
    double last = 1e9;
    for (const int most : {5, 10, 20, 40}) {
      SCOPED_TRACE(std::string(name) + ", " + std::to_string(most));
      const AnyBondLaw toothed = saw_tooth(law, most);
      const Teeth& teeth = *teeth_of(toothed).teeth;
      double above = 0.0, strongest = 0.0;
      for (std::size_t k = 0; k < teeth.strength.size(); ++k) {
        const double s = teeth.strength[k] * toothed.critical();
        above = std::max(above, (teeth.integrity[k] * s - force(law, s)) / largest_force(law));
        strongest = std::max(strongest, teeth.integrity[k] * s / largest_force(law) - 1.0);
      }
      EXPECT_NEAR(above, teeth.band, 1e-5);
      EXPECT_NEAR(strongest, teeth.excess_strength, 1e-5);
      EXPECT_LT(teeth.excess_strength, 0.5 * teeth.band);  // the first teeth are the finest
      EXPECT_LT(teeth.band, 0.75 * last);                  // more teeth, narrower
      last = teeth.band;
    }
  }
}

TEST(SawTooth, IsElasticBetweenItsDrops) {
  const AnyBondLaw toothed = saw_tooth({ForceEnvelope{0.01, 0.04}}, 10);
  const Degraded<AnyBondLaw> bond{3.0, toothed};
  double history = 0.0;
  for (int drop = 0; !bond.is_broken(history); ++drop) {
    const double borne = bond.borne(history), integrity = bond.integrity_after(history);
    for (const double share : {-0.5, 0.2, 0.9, 1.0}) {
      const PotentialDensity<double> found = bond(share * borne, history);
      EXPECT_NEAR(found.first, 3.0 * integrity * share * borne, 1e-14);
      EXPECT_FALSE(bond.is_loading(share * borne, history));
    }
    EXPECT_TRUE(bond.is_loading(1.0001 * borne, history));
    const double next = toothed.borne_after(borne);
    EXPECT_GT(next, history);
    EXPECT_LT(bond.integrity_after(next), integrity);
    history = next;
  }
  EXPECT_EQ(bond(0.03, history).first, 0.0);
}

TEST(SawTooth, BondsOfDifferentRatiosHaveTeethOfTheirOwn) {
  auto own = std::make_shared<BondLaws>(
      std::vector<AnyBondLaw>{{ForceEnvelope{1.0, 2.0}}, {CriticalStretch{1.0}}}, 4);
  own->set(0, 0, 0.01, 0.02);
  own->set(1, 0, 0.02, 0.04);  // the same law, scaled
  own->set(2, 0, 0.01, 0.06);
  own->set(3, 1, 0.03, 0.03);
  const DegradedByBond<Harmonic> smooth{2.0, own};
  const auto saw = std::get<DegradedByBond<Harmonic>>(with_teeth(smooth, 12));
  for (Offset bond = 0; bond < 4; ++bond) {
    const double critical = saw.of_bond(bond).law.critical();
    EXPECT_EQ(critical, smooth.of_bond(bond).law.critical());
    EXPECT_NEAR(saw.of_bond(bond).dissipated(critical), smooth.of_bond(bond).dissipated(critical),
                1e-8 * smooth.of_bond(bond).dissipated(critical));
    EXPECT_TRUE(saw.of_bond(bond).law.falls_by_steps());
  }
  EXPECT_EQ(saw.laws->law_of(0), saw.laws->law_of(1));
  EXPECT_NE(saw.laws->law_of(0), saw.laws->law_of(2));
}

TEST(SawTooth, LeavesABrittleLawAsItIs) {
  const auto brittle =
      std::get<Degraded<CriticalStretch>>(with_teeth(Degraded<CriticalStretch>{2.0, {0.02}}, 20));
  EXPECT_EQ(brittle.law.critical_stretch, 0.02);
}

}  // namespace
}  // namespace peristat
