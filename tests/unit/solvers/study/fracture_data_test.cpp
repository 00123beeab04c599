#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/formulations/formulations.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// Of a bar, whose strength is E times the largest force of its bonds.
FractureScale of_bar() {
  MaterialSpecification material;
  material.youngs_modulus = 70e9;
  return fracture_scale_of(material, "m", {{1, 3e-3, 2e-6}}, 1e-3);
}

const FractureScale scale = of_bar();
constexpr double energy = 10.0;
const double unit = scale.micromodulus * scale.crossing;  // G over W
const double brittle = std::sqrt(2.0 * energy / unit);

const std::vector<DamageLaw> softening{
    DamageLaw::tanh,    DamageLaw::tanh_continuous, DamageLaw::linear,     DamageLaw::exponential,
    DamageLaw::blended, DamageLaw::bilinear,        DamageLaw::cornelissen};

DamageSpecification law(DamageLaw of) {
  DamageSpecification damage;
  damage.law = of;
  return damage;
}

/// Largest onset of a bond with the work W over that of a brittle one, sqrt(2 W): for laws that
/// open, W = s_m s_c (5/18 or 0.1947) and s_c > 3 s_m or 6.957 s_m.
double largest_share(DamageLaw of) {
  return of == DamageLaw::bilinear ? std::sqrt(0.6) : of == DamageLaw::cornelissen ? 0.6075 : 1.0;
}

TEST(FractureData, OfABrittleBondGiveItsStretch) {
  DamageSpecification damage = law(DamageLaw::critical_stretch);
  damage.fracture_energy = energy;
  EXPECT_NEAR(with_stretches(damage, "m", scale).critical / brittle, 1.0, 1e-14);
  damage.fracture_energy.reset();
  damage.strength = 14e6;
  EXPECT_NEAR(with_stretches(damage, "m", scale).critical / 2e-4, 1.0, 1e-9);
}

TEST(FractureData, OfEveryLawThatSoftensComeBack) {
  for (const DamageLaw of : softening) {
    for (const double share : {0.7, 0.83, 0.95}) {
      DamageSpecification damage = law(of);
      damage.fracture_energy = energy;
      damage.strength = share * largest_share(of) * brittle * scale.youngs_modulus;
      if (of == DamageLaw::blended) damage.hardening = 0.9;
      const DamageSpecification found = with_stretches(damage, "m", scale);
      EXPECT_NEAR(unit * total_work(found) / energy, 1.0, 1e-12) << int(of);
      EXPECT_NEAR(scale.youngs_modulus * peak_force(found) / *damage.strength, 1.0, 1e-8);
      EXPECT_FALSE(found.is_by_data());
      EXPECT_LT(found.onset, found.critical);
    }
  }
}

TEST(FractureData, WithAnOnsetOrAloneGiveTheFractureEnergy) {
  for (const DamageLaw of : softening) {
    DamageSpecification damage = law(of);
    damage.fracture_energy = energy;
    const DamageSpecification alone = with_stretches(damage, "m", scale);
    EXPECT_NEAR(unit * total_work(alone) / energy, 1.0, 1e-12);
    EXPECT_NEAR(alone.onset / brittle, of == DamageLaw::blended ? 0.25 : 0.5, 1e-14);
    damage.onset = 0.3 * brittle;
    if (of == DamageLaw::blended) damage.peak = 0.5 * brittle;
    const DamageSpecification begun = with_stretches(damage, "m", scale);
    EXPECT_NEAR(unit * total_work(begun) / energy, 1.0, 1e-12);
    EXPECT_EQ(begun.onset, damage.onset);
  }
}

TEST(FractureData, GiveTheOnsetOfACriticalStretchByTheStrength) {
  for (const DamageLaw of : softening) {
    DamageSpecification damage = law(of);
    damage.critical = 4e-4;
    damage.strength = (damage.opens() ? 0.1 : 0.8) * 4e-4 * scale.youngs_modulus;
    if (of == DamageLaw::blended) damage.hardening = 0.95;
    const DamageSpecification found = with_stretches(damage, "m", scale);
    EXPECT_EQ(found.critical, 4e-4);
    EXPECT_NEAR(scale.youngs_modulus * peak_force(found) / *damage.strength, 1.0, 1e-8);
  }
}

/// The closed forms: s_c = 2 W/s_m, and for the default s_m = s_0/2, s_c = 2 s_0.
TEST(FractureData, OfTheLinearLawHaveAClosedForm) {
  DamageSpecification damage = law(DamageLaw::linear);
  damage.fracture_energy = energy;
  EXPECT_NEAR(with_stretches(damage, "m", scale).critical / (2.0 * brittle), 1.0, 1e-14);
  damage.strength = 7e6;
  EXPECT_NEAR(with_stretches(damage, "m", scale).critical / (2.0 * energy / unit / 1e-4), 1.0,
              1e-8);
}

TEST(FractureData, OfATableAreItsOwn) {
  DamageSpecification damage = law(DamageLaw::table);
  damage.stretches = {1e-4, 2e-4, 4e-4};
  damage.forces = {1e-4, 1.5e-4, 0.0};
  const DamageSpecification found = with_stretches(damage, "m", scale);
  EXPECT_DOUBLE_EQ(found.onset, 1e-4);
  EXPECT_EQ(found.critical, 4e-4);
  EXPECT_DOUBLE_EQ(peak_force(found), 1.5e-4);
  EXPECT_NEAR(total_work(found), (0.5 + 1.25 + 1.5) * 1e-8, 1e-22);
}

std::string refusal(const DamageSpecification& damage) {
  try {
    static_cast<void>(with_stretches(damage, "m", scale));
  } catch (const InputError& error) {
    return error.key() + ": " + error.allowed();
  }
  return "not refused";
}

bool tells(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(FractureData, TooStrongForTheHorizonAreRefusedWithASpacingThatResolvesThem) {
  for (const DamageLaw of : softening) {
    DamageSpecification damage = law(of);
    damage.fracture_energy = energy;
    const double strength = 2.0 * largest_share(of) * brittle * scale.youngs_modulus;
    damage.strength = strength;
    if (of == DamageLaw::blended) damage.onset = 1.999 * brittle;  // its rise takes next to nothing
    const std::string told = refusal(damage);
    EXPECT_TRUE(tells(told, damage.opens()
                                ? "m.damage.strength: bonds of this horizon would snap back"
                                : "m.damage.strength: bonds of this horizon would break"))
        << told;
    EXPECT_TRUE(tells(told, "spacing below 0.000249") || tells(told, "spacing below 0.00025 m"))
        << told;
    // A little below that spacing it is found: W grows as the spacing falls.
    FractureScale finer = scale;
    finer.crossing *= 0.2487;
    finer.spacing *= 0.2487;
    EXPECT_LT(with_stretches(damage, "m", finer).onset,
              with_stretches(damage, "m", finer).critical);
    // 1e-3: of the digits of largest_share.
    EXPECT_NEAR(largest_spacing(damage, energy, strength, scale) / 2.5e-4, 1.0, 1e-3);
  }
}

TEST(FractureData, OfLawsThatOpenAreTheOpeningsOfTheirCurves) {
  DamageSpecification damage = law(DamageLaw::bilinear);
  damage.fracture_energy = energy;
  damage.strength = 7e6;
  // W = s_m s_c / 3.6
  EXPECT_NEAR(with_stretches(damage, "m", scale).critical / (3.6 * energy / unit / 1e-4), 1.0,
              1e-8);
  damage.law = DamageLaw::cornelissen;
  EXPECT_NEAR(with_stretches(damage, "m", scale).critical / (5.136 * energy / unit / 1e-4), 1.0,
              1e-4);
}

TEST(FractureData, ABrittleBondHasNotBoth) {
  DamageSpecification damage = law(DamageLaw::critical_stretch);
  damage.fracture_energy = energy;
  damage.strength = 2.0 * brittle * scale.youngs_modulus;
  const std::string told = refusal(damage);
  EXPECT_TRUE(tells(told, "the fracture energy is 40 J/m2")) << told;  // as the square
}

TEST(FractureData, TooWeakForATanhLawAreRefused) {
  DamageSpecification damage = law(DamageLaw::tanh);
  damage.fracture_energy = energy;
  damage.strength = 1e-3 * brittle * scale.youngs_modulus;
  EXPECT_TRUE(tells(refusal(damage), "too small for a tanh law"));
}

TEST(FractureData, OfTheWrongUnitAreNotCalledThoseOfATanhLaw) {
  DamageSpecification damage = law(DamageLaw::linear);
  damage.fracture_energy = energy;
  damage.strength = 3.0;  // MPa are meant
  const std::string told = refusal(damage);
  EXPECT_FALSE(tells(told, "tanh")) << told;
  EXPECT_TRUE(tells(told, "The strength is in Pa: 3 MPa are 3e6")) << told;
}

/// G = K^2 / E' with the Poisson ratio of the model.
TEST(FractureToughness, GivesTheFractureEnergyOfEveryModel) {
  constexpr double modulus = 70e9, toughness = 0.8e6;
  struct Of {
    MaterialModel model;
    int dimension;
    PlaneState plane;
    double poisson_ratio;
    bool is_thin;
  };
  for (const Of& of : {Of{MaterialModel::bond, 2, PlaneState::stress, 1.0 / 3.0, true},
                       Of{MaterialModel::bond, 2, PlaneState::strain, 0.25, false},
                       Of{MaterialModel::bond, 3, PlaneState::stress, 0.25, false},
                       Of{MaterialModel::lps, 2, PlaneState::strain, 0.4, false},
                       Of{MaterialModel::lps, 2, PlaneState::stress, 0.4, true},
                       Of{MaterialModel::cpd, 2, PlaneState::stress, 0.4, true},
                       Of{MaterialModel::cpd, 3, PlaneState::stress, 0.3, false}}) {
    BondSetting setting{{of.dimension, 2.015e-3, 1.0}, of.plane};
    setting.lattice = {Spacing(1e-3)};
    MaterialSpecification material;
    material.model = of.model;
    material.plane = of.plane;
    material.youngs_modulus = modulus;
    if (of.model != MaterialModel::bond) material.poisson_ratio = of.poisson_ratio;
    material.damage = law(DamageLaw::critical_stretch);
    material.damage.fracture_toughness = toughness;
    const MaterialSpecification found = with_fracture_energy(material, "m", setting, 1e-3);
    const double nu = of.poisson_ratio;
    const double effective = of.is_thin ? modulus : modulus / (1.0 - nu * nu);
    EXPECT_NEAR(*found.damage.fracture_energy / (toughness * toughness / effective), 1.0, 1e-12)
        << int(of.model) << " in " << of.dimension;
    EXPECT_FALSE(found.damage.fracture_toughness);
  }
}

/// The strength is that of the body, whatever its lattice and law, not E times the force of a bond.
TEST(FractureData, GiveABodyItsStrength) {
  for (const int dimension : {2, 3}) {
    for (const bool has_lattice : {true, false}) {
      for (const PlaneState plane : {PlaneState::stress, PlaneState::strain}) {
        if (dimension == 3 && (plane == PlaneState::strain || !has_lattice)) continue;
        BondSetting setting{{dimension, 2.015e-3, dimension == 2 ? 2e-3 : 1.0}, plane};
        if (has_lattice) setting.lattice = {Spacing(1e-3)};
        MaterialSpecification material;
        material.youngs_modulus = 30e9;
        material.plane = plane;
        material.damage = law(DamageLaw::linear);
        material.damage.fracture_energy = 110.0;
        material.damage.strength = 3e6;
        const FractureScale of = fracture_scale_of(material, "m", setting, 1e-3);
        const DamageSpecification found = with_stretches(material.damage, "m", of);
        EXPECT_NEAR(of.strength(found) / 3e6, 1.0, 1e-8);
        EXPECT_NEAR(of.energy(found) / 110.0, 1.0, 1e-8);
        EXPECT_LT(30e9 * peak_force(found), 0.85 * 3e6);
      }
    }
  }
}

/// Bonds along the axes alone bear what no direction but theirs is pulled with.
TEST(FractureData, OfALatticeWithoutShearStiffnessHaveNoStrength) {
  MaterialSpecification material;
  material.youngs_modulus = 30e9;
  material.damage = law(DamageLaw::critical_stretch);
  material.damage.strength = 3e6;
  BondSetting setting{{2, 1.1e-3, 2e-3}};
  setting.lattice = {Spacing(1e-3)};
  const FractureScale of = fracture_scale_of(material, "m", setting, 1e-3);
  EXPECT_THROW(static_cast<void>(with_stretches(material.damage, "m", of)), InputError);
}

TEST(FractureData, OfPlaneStressAreThoseOfTheBooks) {
  BondSetting setting{{2, 3e-3, 2e-3}, PlaneState::stress};
  MaterialSpecification material;
  material.youngs_modulus = 70e9;
  material.damage = law(DamageLaw::critical_stretch);
  material.damage.fracture_energy = energy;
  const FractureScale of = fracture_scale_of(material, "m", setting, 1e-3);
  const double book = std::sqrt(4.0 * std::numbers::pi * energy / (9.0 * 70e9 * 3e-3));
  EXPECT_NEAR(with_stretches(material.damage, "m", of).critical / book, 1.0, 1e-14);
}

MaterialSpecification cpd(DamageLaw of) {
  MaterialSpecification material;
  material.model = MaterialModel::cpd;
  material.youngs_modulus = 70e9;
  material.poisson_ratio = 0.4;
  material.damage = law(of);
  material.damage.drive = DamageDrive::stretch;
  return material;
}

TEST(FractureData, OfCpdComeBackAsTheEnergyOfATear) {
  for (const int dimension : {2, 3}) {
    const BondSetting setting{{dimension, 2e-3, dimension == 2 ? 2e-3 : 1.0}};
    MaterialSpecification whole = cpd(DamageLaw::critical_stretch);
    whole.damage.fracture_energy = energy;
    const FractureScale of = fracture_scale_of(whole, "m", setting, 1e-3);
    const DamageSpecification sudden = with_stretches(whole.damage, "m", of);
    EXPECT_NEAR(of.energy(sudden) / energy, 1.0, 1e-9);
    const double strength = of.strength(sudden);
    for (const DamageLaw each : softening) {
      DamageSpecification damage = law(each);
      damage.fracture_energy = energy;
      const DamageSpecification alone = with_stretches(damage, "m", of);
      EXPECT_NEAR(of.energy(alone) / energy, 1.0, 1e-9) << int(each);
      damage.strength = 0.8 * largest_share(each) * strength;
      if (each == DamageLaw::blended) damage.hardening = 0.9;
      const DamageSpecification strong = with_stretches(damage, "m", of);
      EXPECT_NEAR(of.energy(strong) / energy, 1.0, 1e-9) << int(each);
      EXPECT_NEAR(of.strength(strong) / *damage.strength, 1.0, 1e-8);
      damage = law(each);
      damage.fracture_energy = energy;
      damage.onset = 0.4 * sudden.critical;
      if (each == DamageLaw::blended) damage.peak = 0.6 * sudden.critical;
      const DamageSpecification begun = with_stretches(damage, "m", of);
      EXPECT_NEAR(of.energy(begun) / energy, 1.0, 1e-9) << int(each);
      EXPECT_EQ(begun.onset, damage.onset);
      // Where bonds have the strength of brittle ones they are brittle.
      damage = law(each);
      damage.fracture_energy = energy;
      damage.strength = 1.3 * strength;
      if (each == DamageLaw::blended) damage.onset = 1.29 * sudden.critical;
      EXPECT_THROW(static_cast<void>(with_stretches(damage, "m", of)), InputError) << int(each);
    }
    EXPECT_NEAR(largest_spacing(whole.damage, energy, strength, of) / 1e-3, 1.0, 1e-9);
    DamageSpecification both = law(DamageLaw::critical_stretch);
    both.fracture_energy = energy;
    both.strength = strength;
    EXPECT_THROW(static_cast<void>(with_stretches(both, "m", of)), InputError);
  }
}

TEST(FractureData, OfCpdAreRefusedWhereTheyWouldTakeMinutes) {
  const BondSetting setting{{3, 4e-3, 1.0}};
  MaterialSpecification material = cpd(DamageLaw::critical_stretch);
  material.damage.critical = 0.01;
  EXPECT_FALSE(fracture_scale_of(material, "m", setting, 1e-3).tear);
  material.damage.critical = 0.0;
  material.damage.fracture_energy = energy;
  EXPECT_THROW(static_cast<void>(fracture_scale_of(material, "m", setting, 1e-3)), InputError);
  material.damage.law = DamageLaw::tanh;
  material.damage.rate = 50.0;
  const BondSetting shorter{{3, 3.015e-3, 1.0}};
  const FractureScale of = fracture_scale_of(material, "m", shorter, 1e-3);
  EXPECT_THROW(static_cast<void>(with_stretches(material.damage, "m", of)), InputError);
}

TEST(FractureData, OfCpdAreRefusedForNegativeConstants) {
  const BondSetting setting{{2, 2e-3, 2e-3}};
  MaterialSpecification material = cpd(DamageLaw::critical_stretch);
  material.poisson_ratio = 0.1;
  material.damage.fracture_energy = energy;
  EXPECT_THROW(static_cast<void>(fracture_scale_of(material, "m", setting, 1e-3)), InputError);
}

/// By release G = C1 A M at any horizon and Poisson's ratio from 0 on: only bonds take energy.
TEST(FractureData, OfCpdByReleaseAreThoseOfItsBonds) {
  for (const int dimension : {2, 3}) {
    const double ratio = dimension == 2 ? 13.0 : 4.0;
    const BondSetting setting{{dimension, ratio * 1e-3, dimension == 2 ? 2e-3 : 1.0}};
    for (const double nu : {0.0, 0.1, 0.4}) {
      MaterialSpecification material = cpd(DamageLaw::exponential);
      material.poisson_ratio = nu;
      material.damage.drive.reset();  // follows from the fracture energy
      material.damage.fracture_energy = energy;
      const FractureScale of = fracture_scale_of(material, "m", setting, 1e-3);
      const DamageSpecification found = with_stretches(material.damage, "m", of);
      EXPECT_NEAR(of.micromodulus * of.crossing * total_work(found) / energy, 1.0, 1e-12);
      EXPECT_NEAR(of.energy(found) / energy, 1.0, 1e-12);
      EXPECT_FALSE(of.pull);
      material.damage.strength = 1e6;
      EXPECT_THROW(static_cast<void>(fracture_scale_of(material, "m", setting, 1e-3)), InputError);
    }
    MaterialSpecification auxetic = cpd(DamageLaw::linear);
    auxetic.poisson_ratio = -1e-3;
    auxetic.damage.drive = DamageDrive::release;
    EXPECT_THROW(static_cast<void>(fracture_scale_of(auxetic, "m", setting, 1e-3)), InputError);
  }
}

}  // namespace
}  // namespace peristat
