/// Case files and users of the library are refused with the same words: the rules stand once.

#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "cases/runner/input/case.hpp"
#include "solvers/formulations/check_specification.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

struct Rule {
  std::string name, key;  ///< of the case file
  std::string lines;      ///< after those of the plate
  std::function<void(BodySpecification&)> change;
};

const std::string plate = R"(
dimension = 2
[lattice]
spacing = 0.1
shape = [{ add = "box", min = [0, 0], max = [1, 1] }]
layer = [{ name = "low", side = "y-" }]
[[support]]
set = "low"
displacement = [0, 0]
)";

template <class Refused>
InputError error_of(const Refused& refused) {
  try {
    refused();
  } catch (const InputError& error) {
    return error;
  }
  return {"", "", "is accepted"};
}

class RefusedAlike : public testing::TestWithParam<Rule> {};

TEST_P(RefusedAlike, ByFileAndLibrary) {
  const auto& [name, key, lines, change] = GetParam();
  BodySpecification of;
  of.material.youngs_modulus = 1e9;
  change(of);
  const InputError of_file =
      error_of([&] { static_cast<void>(read_case("a.toml", plate + lines, {})); });
  const InputError of_library = error_of([&] { check_materials(of, 2); });
  EXPECT_EQ(of_file.allowed(), of_library.allowed());
  EXPECT_NE(of_file.allowed(), "is accepted");
  EXPECT_NE(of_file.place().find("a.toml:"), std::string::npos);
  EXPECT_NE(std::string(of_file.what()).find(key), std::string::npos) << of_file.what();
}

const std::string bond = "[material]\nyoungs_modulus = 1e9\n";
const std::string solid = bond + "poisson_ratio = 0.2\nmodel = ";
const std::string damage = bond + "[material.damage]\n";
const std::string regions =
    bond + "[[region]]\nset = \"low\"\n[region.material]\nyoungs_modulus = 2e9\n";

void make_solid(BodySpecification& of, MaterialModel model) {
  of.material.model = model;
  of.material.poisson_ratio = 0.2;
}
/// A table of forces that is refused.
Rule table_rule(const char* name, const char* key, const std::vector<double>& stretches,
                const std::vector<double>& forces) {
  const auto list = [](const std::vector<double>& numbers) {
    std::string text;
    for (const double number : numbers) text += (text.empty() ? "[" : ", ") + number_text(number);
    return text + "]\n";
  };
  return {name, std::string("material.damage.") + key,
          damage + "law = \"table\"\nstretches = " + list(stretches) + "forces = " + list(forces),
          [=](auto& of) {
            of.material.damage = {
                .law = DamageLaw::table, .stretches = stretches, .forces = forces};
          }};
}
void add_region(BodySpecification& of) { of.regions.push_back({"low", of.material}); }

INSTANTIATE_TEST_SUITE_P(
    Rules, RefusedAlike,
    testing::Values(
        Rule{"ConstantOfAnotherModel", "material.c2", bond + "c2 = 1.0",
             [](auto& of) { of.material.c2 = 1.0; }},
        Rule{"RatioOfBonds", "material.poisson_ratio", bond + "poisson_ratio = 0.2",
             [](auto& of) { of.material.poisson_ratio = 0.2; }},
        Rule{"MicromodulusOfASolid", "material.micromodulus",
             "[material]\nmodel = \"lps\"\nmicromodulus = 1.0",
             [](auto& of) {
               of.material = {};
               of.material.model = MaterialModel::lps;
               of.material.micromodulus = 1.0;
             }},
        Rule{"PlaneOfCpd", "material.plane", solid + "\"cpd\"\nplane = \"strain\"",
             [](auto& of) {
               make_solid(of, MaterialModel::cpd);
               of.material.plane = PlaneState::strain;
             }},
        Rule{"KinematicsOfCpd", "material.kinematics", solid + "\"cpd\"\nkinematics = \"linear\"",
             [](auto& of) {
               make_solid(of, MaterialModel::cpd);
               of.material.kinematics = Kinematics::linear;
             }},
        Rule{"CalibrationOfASolid", "material.calibration",
             solid + "\"correspondence\"\ncalibration = \"lattice\"",
             [](auto& of) {
               make_solid(of, MaterialModel::correspondence);
               of.material.calibration = Calibration::lattice;
             }},
        Rule{"CorrectionOfCpd", "quadrature.surface_correction",
             "[quadrature]\nsurface_correction = \"energy\"\n" + solid + "\"cpd\"",
             [](auto& of) {
               make_solid(of, MaterialModel::cpd);
               of.surface_correction = SurfaceCorrection::energy;
             }},
        Rule{"FormOfBonds", "quadrature.form", "[quadrature]\nform = \"energy\"\n" + bond,
             [](auto& of) { of.form = SolidForm::energy; }},
        Rule{"SofteningSolid", "material.damage.law",
             solid + "\"lps\"\n[material.damage]\nlaw = \"linear\"\nonset = 0.01\ncritical = 0.02",
             [](auto& of) {
               make_solid(of, MaterialModel::lps);
               of.material.damage = {.law = DamageLaw::linear, .onset = 0.01, .critical = 0.02};
             }},
        Rule{"OnsetOfABrittleBond", "material.damage.onset",
             damage + "law = \"critical_stretch\"\nonset = 0.01\ncritical = 0.02",
             [](auto& of) {
               of.material.damage = {
                   .law = DamageLaw::critical_stretch, .onset = 0.01, .critical = 0.02};
             }},
        Rule{"CriticalTwice", "material.damage.critical",
             damage + "law = \"critical_stretch\"\nfracture_energy = 10.0\ncritical = 0.02",
             [](auto& of) {
               of.material.damage = {.law = DamageLaw::critical_stretch, .critical = 0.02};
               of.material.damage.fracture_energy = 10.0;
             }},
        Rule{
            "ToughnessBesideAnEnergy", "material.damage.fracture_toughness",
            damage + "law = \"critical_stretch\"\nfracture_energy = 10.0\nfracture_toughness = 1e6",
            [](auto& of) {
              of.material.damage = {.law = DamageLaw::critical_stretch};
              of.material.damage.fracture_energy = 10.0;
              of.material.damage.fracture_toughness = 1e6;
            }},
        Rule{"CriticalBesideAToughness", "material.damage.critical",
             damage + "law = \"critical_stretch\"\nfracture_toughness = 1e6\ncritical = 0.02",
             [](auto& of) {
               of.material.damage = {.law = DamageLaw::critical_stretch, .critical = 0.02};
               of.material.damage.fracture_toughness = 1e6;
             }},
        table_rule("ForceThatGrowsTooMuch", "forces[2]", {0.01, 0.02, 0.03}, {0.01, 0.01, 0.016}),
        table_rule("ForceOfNoElasticPart", "forces[0]", {0.01, 0.02}, {0.011, 0.0}),
        table_rule("ForceThatComesBack", "forces[1]", {0.01, 0.02, 0.03}, {0.01, 0.0, 0.0}),
        table_rule("ForceMissing", "forces", {0.01, 0.02, 0.03}, {0.01, 0.0}),
        table_rule("ForceThatNeverFalls", "forces", {0.01, 0.02}, {0.01, 0.02}),
        table_rule("StretchesThatDescend", "stretches[1]", {0.01, 0.005}, {0.01, 0.0}),
        Rule{"CriticalOfATable", "material.damage.critical",
             damage +
                 "law = \"table\"\nstretches = [0.01, 0.02]\nforces = [0.01, 0]\ncritical = 0.02",
             [](auto& of) {
               of.material.damage = {.law = DamageLaw::table,
                                     .critical = 0.02,
                                     .stretches = {0.01, 0.02},
                                     .forces = {0.01, 0.0}};
             }},
        Rule{"StretchesOfALinearLaw", "material.damage.stretches",
             damage + "law = \"linear\"\nonset = 0.01\ncritical = 0.02\nstretches = [0.01, 0.02]",
             [](auto& of) {
               of.material.damage = {.law = DamageLaw::linear,
                                     .onset = 0.01,
                                     .critical = 0.02,
                                     .stretches = {0.01, 0.02}};
             }},
        Rule{"PeakOfALinearLaw", "material.damage.peak",
             damage + "law = \"linear\"\nonset = 0.01\npeak = 0.015\ncritical = 0.02",
             [](auto& of) {
               of.material.damage = {.law = DamageLaw::linear, .onset = 0.01, .critical = 0.02};
               of.material.damage.peak = 0.015;
             }},
        Rule{"OtherModelOfARegion", "region[0].material.model",
             regions + "model = \"cpd\"\npoisson_ratio = 0.3",
             [](auto& of) {
               add_region(of);
               of.regions.front().material.model = MaterialModel::cpd;
             }},
        Rule{"PairTwice", "interface[1]",
             regions + "[[interface]]\nbetween = [\"low\", \"material\"]\n"
                       "[[interface]]\nbetween = [\"material\", \"low\"]",
             [](auto& of) {
               add_region(of);
               of.interfaces.resize(2);
               of.interfaces[0].between = {"low", rest_name};
               of.interfaces[1].between = {rest_name, "low"};
             }},
        Rule{"OneOfAPair", "interface[0]", regions + "[[interface]]\nbetween = [\"low\", \"low\"]",
             [](auto& of) {
               add_region(of);
               of.interfaces.resize(1);
               of.interfaces[0].between = {"low", "low"};
             }}),
    [](const auto& rule) { return rule.param.name; });

/// A horizon per point is for points from a file.
TEST(RefusedAlikeWithPoints, WhatNeedsOneHorizon) {
  const std::string file = testing::TempDir() + "refused_alike_points.csv";
  std::ofstream(file) << "x, y, volume\n0, 0, 1\n1, 0, 1\n";
  const std::string points =
      "dimension = 2\n[points]\nfile = \"" + file + "\"\nhorizon = { ratio = 3.015 }\n";
  const auto make = [](MaterialModel model) {
    BodySpecification of;
    of.horizon_per_size = 3.015;
    of.material.youngs_modulus = 1e9;
    if (model != MaterialModel::bond) make_solid(of, model);
    return of;
  };
  std::vector<std::pair<std::string, BodySpecification>> refused;
  refused.emplace_back(solid + "\"cpd\"", make(MaterialModel::cpd));
  refused.emplace_back(solid + "\"lps\"", make(MaterialModel::lps));
  refused.emplace_back(solid + "\"correspondence\"", make(MaterialModel::correspondence));
  refused.emplace_back(bond + "model = \"green_bond\"", make(MaterialModel::bond));
  refused.back().second.material.model = MaterialModel::green_bond;
  refused.emplace_back("[material]\nmicromodulus = 1.0", make(MaterialModel::bond));
  refused.back().second.material.youngs_modulus.reset();
  refused.back().second.material.micromodulus = 1.0;
  refused.emplace_back(damage + "law = \"blended\"\nfracture_energy = 10.0\nstrength = 1e6",
                       make(MaterialModel::bond));
  refused.back().second.material.damage.law = DamageLaw::blended;
  refused.back().second.material.damage.fracture_energy = 10.0;
  refused.back().second.material.damage.strength = 1e6;
  refused.emplace_back("[quadrature]\nvolume_correction = \"exact\"\n" + bond,
                       make(MaterialModel::bond));
  refused.back().second.volume_correction = VolumeCorrection::exact;
  for (const auto& [lines, of] : refused) {
    const InputError of_file =
        error_of([&] { static_cast<void>(read_case("a.toml", points + lines, {})); });
    const InputError of_library = error_of([&] { check_materials(of, 2); });
    EXPECT_EQ(of_file.allowed(), of_library.allowed());
    EXPECT_NE(of_file.allowed(), "is accepted") << lines;
    EXPECT_NE(of_file.place().find("a.toml:"), std::string::npos) << of_file.what();
  }
}

}  // namespace
}  // namespace peristat
