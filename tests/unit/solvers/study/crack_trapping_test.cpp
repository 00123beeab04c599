#include "solvers/study/crack_trapping.hpp"

#include <gtest/gtest.h>

namespace peristat {
namespace {

BodySpecification with_law(DamageLaw law, double horizon) {
  BodySpecification of;
  of.horizon = horizon;
  of.material.damage.law = law;
  return of;
}

TEST(CrackTrapping, BrittleBondsTellWhatWasMeasuredAtTheirRatio) {
  const auto told = crack_trapping(with_law(DamageLaw::critical_stretch, 3.015e-3), 2, 1e-3);
  ASSERT_TRUE(told);
  ASSERT_TRUE(told->needed);
  EXPECT_GT(told->needed->first, 1.1);
  EXPECT_NE(description(*told).find("it runs at 1.14 to 1.19 of K_Ic"), std::string::npos);
}

TEST(CrackTrapping, WhatWasNotMeasuredIsSaidSo) {
  for (const auto& [dimension, horizon] : {std::pair(2, 3.3e-3), {3, 3.015e-3}, {2, 8e-3}}) {
    const auto told =
        crack_trapping(with_law(DamageLaw::critical_stretch, horizon), dimension, 1e-3);
    ASSERT_TRUE(told);
    EXPECT_FALSE(told->needed);
    EXPECT_NE(description(*told).find("not measured in"), std::string::npos);
  }
}

TEST(CrackTrapping, WasMeasuredOfTheConstantInfluenceFunctionAlone) {
  BodySpecification cubic = with_law(DamageLaw::critical_stretch, 3.015e-3);
  cubic.material.influence = "cubic";
  const auto told = crack_trapping(cubic, 2, 1e-3);
  ASSERT_TRUE(told);
  EXPECT_FALSE(told->needed);
}

TEST(CrackTrapping, OtherLawsAndBodiesWithoutALatticeAreNotTold) {
  EXPECT_FALSE(crack_trapping(with_law(DamageLaw::linear, 3e-3), 2, 1e-3));
  EXPECT_FALSE(crack_trapping(with_law(DamageLaw::none, 3e-3), 2, 1e-3));
  EXPECT_FALSE(crack_trapping(with_law(DamageLaw::critical_stretch, 3e-3), 2, 0.0));
  EXPECT_FALSE(crack_trapping(with_law(DamageLaw::critical_stretch, 3e-3), 1, 1e-3));
  BodySpecification cpd = with_law(DamageLaw::critical_stretch, 3e-3);
  cpd.material.model = MaterialModel::cpd;
  EXPECT_FALSE(crack_trapping(cpd, 2, 1e-3));
}

}  // namespace
}  // namespace peristat
