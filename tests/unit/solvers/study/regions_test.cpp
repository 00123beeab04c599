#include <cmath>
#include <numeric>
#include <variant>

#include <gtest/gtest.h>

#include "solvers/body/body.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// A bar of ten points whose lower half is "low".
Points bar() {
  Points points;
  points.dimension = 1;
  points.spacing = 1.0;
  for (int k = 0; k < 10; ++k) {
    points.reference.push_back(k + 0.5);
    points.volume.push_back(1.0);
    points.sets[k < 5 ? "low" : "high"].push_back(k);
    if (k >= 4) points.sets["more"].push_back(k);
  }
  return points;
}

BodySpecification of_two(double low, double high) {
  BodySpecification of{.horizon = 2.0};
  of.regions = {{"low", {.youngs_modulus = low}}, {"high", {.youngs_modulus = high}}};
  return of;
}

std::string refusal(const BodySpecification& of) {
  try {
    static_cast<void>(make_body(bar(), of, 1));
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Regions, OfOneMaterialAreThatBodyToTheLastBit) {
  BodySpecification of{.horizon = 2.0};
  of.material.youngs_modulus = 3.0;
  of.material.damage = {DamageLaw::tanh, 0.01, 0.02};
  const auto whole = make_body(bar(), of, 1);
  BodySpecification parts{.horizon = 2.0};
  parts.regions = {{"low", of.material}, {"high", of.material}};
  const auto joined = make_body(bar(), parts, 1);
  ASSERT_EQ(whole->model.bonds().count(), joined->model.bonds().count());
  EXPECT_EQ(whole->model.bond_failure()->potential().index(),
            joined->model.bond_failure()->potential().index());
  for (Offset bond = 0; bond < whole->model.bonds().count(); ++bond) {
    EXPECT_EQ(whole->model.bonds().weight(bond), joined->model.bonds().weight(bond));
  }
  EXPECT_EQ(joined->region, (std::vector<std::int32_t>{0, 0, 0, 0, 0, 1, 1, 1, 1, 1}));
  EXPECT_TRUE(whole->region.empty());
}

TEST(Regions, BondsBetweenThemHaveConstantsByTheRule) {
  const std::vector<std::pair<InterfaceRule, double>> rules{{InterfaceRule::harmonic, 3.0},
                                                            {InterfaceRule::arithmetic, 4.0},
                                                            {InterfaceRule::weaker, 2.0}};
  for (const auto& [rule, expected] : rules) {
    BodySpecification of = of_two(2.0, 6.0);
    of.interfaces = {{.rule = rule}};
    const auto body = make_body(bar(), of, 1);
    const Bonds& bonds = body->model.bonds();
    int met = 0;
    for (Index i = 0; i < bonds.points(); ++i) {
      for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
        const Index j = bonds.partner(i, bond);
        const double modulus = j < 5 ? 2.0 : i >= 5 ? 6.0 : expected;
        EXPECT_DOUBLE_EQ(bonds.weight(bond), modulus / 2.0);  // over the first material's
        met += i < 5 && j >= 5;
      }
    }
    EXPECT_EQ(met, 3);
  }
}

TEST(Regions, ThatOverlapAreRefused) {
  BodySpecification of = of_two(2.0, 6.0);
  of.regions[1].set = "more";
  EXPECT_EQ(refusal(of),
            "regions[1].set = \"more\": overlaps the region of \"low\": the point at (4.5) m is in "
            "both");
}

TEST(Regions, HaveToTakeEveryPointWithoutAMaterialForTheRest) {
  BodySpecification of = of_two(2.0, 6.0);
  of.regions.pop_back();
  EXPECT_EQ(
      refusal(of),
      "regions: 5 points have no material, one of them at (5.5) m; put them in a region, or give a "
      "[material] for points in no region");
  of.material.youngs_modulus = 1.0;
  const auto body = make_body(bar(), of, 1);
  EXPECT_EQ(body->region, (std::vector<std::int32_t>{0, 0, 0, 0, 0, -1, -1, -1, -1, -1}));
}

TEST(Regions, BondsWithoutALawDoNotFail) {
  BodySpecification of = of_two(2.0, 6.0);
  of.regions[1].material.damage = {DamageLaw::critical_stretch, 0.0, 0.02};
  const auto body = make_body(bar(), of, 1);
  const std::vector<double> history = body->model.bond_failure()->initial_history();
  const Bonds& bonds = body->model.bonds();
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      EXPECT_EQ(history[std::size_t(bond)], bonds.partner(i, bond) < 5 ? never_failing : 0.0);
    }
  }
}

/// Their stretches are found, and like but for round-off.
TEST(Regions, BlendedLawsOfTwoFractureEnergiesAreAlike) {
  for (const double energy : {7.0, 11.0, 50.0, 60.0}) {
    BodySpecification of = of_two(70e9, 70e9);
    for (RegionSpecification& region : of.regions) {
      region.material.damage.law = DamageLaw::blended;
      region.material.damage.fracture_energy = 10.0;
    }
    of.regions[1].material.damage.fracture_energy = energy;
    const auto body = make_body(bar(), of, 1);
    const auto& law =
        *std::get<DegradedByBond<Harmonic>>(body->model.bond_failure()->potential()).laws;
    const Bonds& bonds = body->model.bonds();
    double low = 0.0, high = 0.0, between = 0.0;
    for (Index i = 0; i < bonds.points(); ++i) {
      for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
        const Index j = bonds.partner(i, bond);
        (i < 5 && j < 5 ? low : i >= 5 && j >= 5 ? high : between) = law.at(bond).critical();
      }
    }
    EXPECT_NEAR(high / low, std::sqrt(energy / 10.0), 1e-9);
    EXPECT_NEAR(between * (1.0 / low + 1.0 / high), 2.0, 1e-9) << energy;
  }
}

TEST(Regions, InterfacesAreOfTwoMaterialsThatMeet) {
  BodySpecification of = of_two(2.0, 6.0);
  of.interfaces = {{.between = {"low", "hih"}}};
  EXPECT_NE(refusal(of).find("interfaces[0].between = \"hih\""), std::string::npos);
  of.interfaces = {{.between = {"low", "high"}}, {.between = {"high", "low"}}};
  EXPECT_NE(refusal(of).find("another interface has the same pair of materials"),
            std::string::npos);
  of.interfaces = {{.between = {"low", "high"}}, {}};
  EXPECT_NE(refusal(of).find("interfaces[1]: no bond joins"), std::string::npos);
  of.interfaces = {{.between = {"low", "material"}}};
  EXPECT_NE(refusal(of).find("interfaces[0].between = \"material\""), std::string::npos);
  of.interfaces = {};
  of.material.youngs_modulus = 1.0;
  EXPECT_EQ(refusal(of), "nothing");
}

TEST(Regions, RefuseConstantsOfOtherModels) {
  BodySpecification of = of_two(2.0, 6.0);
  of.regions[1].material.model = MaterialModel::cpd;
  EXPECT_NE(refusal(of).find("regions[1].material.model"), std::string::npos);
  of = of_two(2.0, -6.0);
  EXPECT_NE(refusal(of).find("regions[1].material.youngs_modulus = -6"), std::string::npos);
  of = of_two(2.0, 6.0);
  of.regions[0].material.scatter = {{.of = ScatterSpecification::Quantity::strength}};
  EXPECT_NE(refusal(of).find("regions[0].material.scatter[0].of: strength needs a law"),
            std::string::npos);
}

}  // namespace
}  // namespace peristat
