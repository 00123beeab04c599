#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "cases/runner/input/case.hpp"
#include "cases/runner/input/unit_system.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

namespace fs = std::filesystem;
using Overrides = std::vector<std::pair<std::string, std::string>>;

class Units : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("peristat_units_" + std::to_string(std::random_device{}()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  Case read(const std::string& text, const Overrides& overrides = {}) const {
    const fs::path file = folder_ / "study.toml";
    std::ofstream(file, std::ios::binary) << text;
    return read_case(file, overrides);
  }
  std::string resolved(const std::string& text, const Overrides& overrides = {}) const {
    return read(text, overrides).as_resolved;
  }
  std::string refusal(const std::string& text, const Overrides& overrides = {}) const {
    try {
      static_cast<void>(read(text, overrides));
    } catch (const InputError& error) {
      const std::string what = error.what();
      const auto at = what.find("study.toml");
      return at == std::string::npos ? what : what.substr(at);
    }
    return {};
  }
  void expect_refusal(const std::string& text, const std::vector<std::string>& fragments,
                      const Overrides& overrides = {}) const {
    const std::string message = refusal(text, overrides);
    for (const std::string& fragment : fragments)
      EXPECT_NE(message.find(fragment), std::string::npos) << fragment << "\nnot in: " << message;
  }

  fs::path folder_;
};

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

const std::string statics = R"(dimension = 2
[lattice]
spacing = [0.001, 0.0007]
thickness = 0.0025
angle = 0.0
[[lattice.shape]]
add = "polygon"
vertices = [[0, 0], [0.0201, 0], [0.0201, 0.01], [0, 0.01]]
[[lattice.shape]]
subtract = "disk"
centre = [0.007, 0.005]
radius = 0.0011
[[lattice.layer]]
name = "left"
side = "x-"
[[set]]
name = "right"
shape = { box = { min = [0.017, 0], max = [0.03, 0.01] } }
[[crack]]
from = [0.0103, -0.001]
to = [0.0103, 0.0037]
[material]
youngs_modulus = 210e9
density = 7850.0
thermal_expansion = 12e-6
[material.damage]
law = "linear"
fracture_energy = 110.0
strength = 3e7
no_fail = ["left"]
[[support]]
set = "left"
displacement = ["-1e-04*load", "free"]
[[load]]
set = "right"
body_force = [70000.0, "-3300000*load/2"]
[[load]]
side = "y+"
pressure = "5e+06*load"
[[load]]
gravity = [0, -9.81]
[[foundation]]
name = "ground"
side = "y-"
modulus = [0, 5e9]
[temperature]
change = "20*load"
[loading]
steps = 2
)";

/// The same in mm, N and s, from which MPa and t follow.
const std::string in_mm = R"(dimension = 2
[units]
length = "mm"
force = "N"
[lattice]
spacing = [1, 0.7]
thickness = 2.5
angle = 0.0
[[lattice.shape]]
add = "polygon"
vertices = [[0, 0], [20.1, 0], [20.1, 10], [0, 10]]
[[lattice.shape]]
subtract = "disk"
centre = [7, 5]
radius = 1.1
[[lattice.layer]]
name = "left"
side = "x-"
[[set]]
name = "right"
shape = { box = { min = [17, 0], max = [30, 10] } }
[[crack]]
from = [10.3, -1]
to = [10.3, 3.7]
[material]
youngs_modulus = 210e3
density = 7.85e-9
thermal_expansion = 12e-6
[material.damage]
law = "linear"
fracture_energy = 0.11
strength = 30
no_fail = ["left"]
[[support]]
set = "left"
displacement = ["-0.1*load", "free"]
[[load]]
set = "right"
body_force = [7e-5, "-3.3e-3*load/2"]
[[load]]
side = "y+"
pressure = "5*load"
[[load]]
gravity = [0, -9810]
[[foundation]]
name = "ground"
side = "y-"
modulus = [0, 5]
[temperature]
change = "20*load"
[loading]
steps = 2
)";

const std::string in_words = R"(dimension = 2
[lattice]
spacing = ["1 mm", "700 um"]
thickness = "0.25 cm"
angle = "0 deg"
[[lattice.shape]]
add = "polygon"
vertices = [[0, 0], ["20.1 mm", 0], ["2.01cm", "10 mm"], [0, 0.01]]
[[lattice.shape]]
subtract = "disk"
centre = ["7 mm", "0.5 cm"]
radius = "1.1 mm"
[[lattice.layer]]
name = "left"
side = "x-"
[[set]]
name = "right"
shape = { box = { min = ["17 mm", 0], max = ["30 mm", "10 mm"] } }
[[crack]]
from = ["10.3 mm", "-1 mm"]
to = ["10.3 mm", "3.7 mm"]
[material]
youngs_modulus = "210 GPa"
density = "7.85 t/m3"
thermal_expansion = "12e-6 1/K"
[material.damage]
law = "linear"
fracture_energy = "0.11 N/mm"
strength = "30 N/mm^2"
no_fail = ["left"]
[[support]]
set = "left"
displacement = ["-0.1 mm*load", "free"]
[[load]]
set = "right"
body_force = ["70 kN/m3", "-3.3 MN/m3*load/2"]
[[load]]
side = "y+"
pressure = "5 MPa*load"
[[load]]
gravity = [0, "-9.81 m/s2"]
[[foundation]]
name = "ground"
side = "y-"
modulus = [0, "5 MPa/mm"]
[temperature]
change = "20 K*load"
[loading]
steps = 2
)";

TEST_F(Units, AreConvertedToTheLastBit) {
  const std::string expected = resolved(statics);
  EXPECT_NE(expected.find("spacing = [0.001, 7e-04]"), std::string::npos) << expected;
  EXPECT_EQ(resolved(in_mm), expected);
  EXPECT_EQ(resolved(in_words), expected);
  EXPECT_EQ(resolved(expected), expected);
}

const std::string motion = R"toml(dimension = 2
[lattice]
spacing = 0.001
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [0.01, 0.004]
[[lattice.layer]]
name = "left"
side = "x-"
[material]
youngs_modulus = 210e9
density = 7850.0
[[support]]
set = "left"
displacement = ["1e-05*sin(2*pi*t/0.002)", 0]
[[initial]]
velocity = ["0.5*x/0.01", 0]
[[absorbing]]
rate = "50000*(x > 0.005)"
[solver]
mode = "dynamics"
[dynamics]
end_time = 2e-06
time_step = 1e-08
)toml";

TEST_F(Units, HoldForMotionsAndForTimesInExpressions) {
  std::string in_ms =
      with(motion, "[lattice]", "[units]\nlength = \"mm\"\ntime = \"ms\"\n[lattice]");
  for (const auto& [si, ms] : std::vector<std::pair<std::string, std::string>>{
           {"spacing = 0.001", "spacing = 1"},
           {"[0.01, 0.004]", "[10, 4]"},
           {"210e9", "210e3"},
           {"7850.0", "7.85e-3"},
           {"1e-05*sin(2*pi*t/0.002)", "0.01*sin(2*pi*t/2)"},
           {"0.5*x/0.01", "0.5*x/10"},
           {"50000*(x > 0.005)", "50*(x > 5)"},
           {"2e-06", "0.002"},
           {"1e-08", "1e-5"}})
    in_ms = with(in_ms, si, ms);
  std::string expected = resolved(motion);
  for (const auto& [si, ms] : std::vector<std::pair<std::string, std::string>>{
           {"1e-05*sin(2*pi*t/0.002)", "1e-05*sin(2*pi*(t*1000)/2)"},
           {"0.5*x/0.01", "0.5*(x*1000)/10"},
           {"50000*(x > 0.005)", "50000*((x*1000) > 5)"}})
    expected = with(expected, si, ms);
  EXPECT_EQ(resolved(in_ms), expected);
  EXPECT_EQ(resolved(expected), expected);
}

TEST_F(Units, EndBeforeTheTimeAndBeforeFunctions) {
  const auto given = [](const std::string& displacement) {
    return with(motion, "1e-05*sin(2*pi*t/0.002)", displacement);
  };
  for (const auto& [typed, si] : std::vector<std::pair<std::string, std::string>>{
           {"2 mm/s*t", "0.002*t"},
           {"-2 mm/s * t", "-0.002 * t"},
           {"5 m/s^2*t^2", "5*t^2"},
           {"2 mm*min(t/(1 ms), 1)", "0.002*min(t/(0.001), 1)"},
           {"2 mm*sin(5 1/ms*t)", "0.002*sin(5000*t)"}})
    EXPECT_NE(resolved(given(typed)).find("[\"" + si + "\", "), std::string::npos)
        << typed << ": " << refusal(given(typed));
  EXPECT_NE(resolved(with(motion, "50000*(x > 0.005)", "50 1/ms*(x > 5 mm)"))
                .find("rate = \"50000*(x > 0.005)\""),
            std::string::npos);
  expect_refusal(given("2.5 MPa"), {"must be a length, e.g. 2.5 mm; MPa is the unit of a stress"});
  expect_refusal(given("-2.5 MPa"), {"must be a length, e.g. 2.5 mm; MPa is the unit of a stress"});
}

TEST_F(Units, OfExpressionsThatAreNoProductsScaleTheWhole) {
  const std::string text =
      with(in_mm, "\"-0.1*load\", \"free\"", "\"0.1*load - 0.2*(x > 3 mm)\", \"y*load\"");
  EXPECT_NE(refusal(text).find("has a value that is a number without a unit; must be a length"),
            std::string::npos);
  const std::string plain = with(text, "3 mm", "3");
  EXPECT_NE(
      resolved(plain).find(R"(["(0.1*load - 0.2*((x*1000) > 3))/1000", "((y*1000)*load)/1000"])"),
      std::string::npos)
      << resolved(plain);
  const std::string beside = with(plain, "0.1*load - 0.2*(x > 3)", "(x > 3 mm)*0.1 mm - 0.2 mm");
  EXPECT_NE(resolved(beside).find(R"(["(((x*1000) > 3)*0.1 - 0.2)/1000")"), std::string::npos)
      << resolved(beside);
}

TEST_F(Units, OfConditionsAndStretchesAreThoseOfTheirVariables) {
  const std::string by_where = with(in_mm, "shape = { box = { min = [17, 0], max = [30, 10] } }",
                                    "where = \"x >= 17 - spacing_x\"");
  EXPECT_NE(resolved(by_where).find("where = \"(x*1000) >= 17 - (spacing_x*1000)\""),
            std::string::npos);
  const std::string in_meters =
      with(statics, "shape = { box = { min = [0.017, 0], max = [0.03, 0.01] } }",
           "where = \"x >= 17 mm && y < 1 cm\"");
  EXPECT_NE(resolved(in_meters).find("where = \"x >= 0.017 && y < 0.01\""), std::string::npos);
  const std::string stretch = with(with(in_mm, "fracture_energy = 0.11\nstrength = 30",
                                        "critical = \"2 %\"\nonset = \"0.03/horizon\""),
                                   "spacing = [1, 0.7]", "spacing = 1");
  EXPECT_DOUBLE_EQ(read(stretch).material.damage.onset, 0.03 / 3.015);
  EXPECT_EQ(read(stretch).material.damage.critical, 0.02);
}

TEST_F(Units, DependOnOtherKeysForTheControlAndForExpectedValues) {
  const std::string controlled = with(
      with(in_mm, "displacement = [\"-0.1*load\", \"free\"]", "displacement = [0, \"free\"]"),
      "steps = 2",
      "steps = 2\ntable = [0, 0.5, \"20 um\"]\n[[control]]\nset = \"right\"\nweights = [1, 0]");
  EXPECT_NE(resolved(controlled).find("table = [0.0, 5e-04, 2e-05]"), std::string::npos)
      << refusal(controlled);
  EXPECT_NE(
      resolved(with(in_mm, "steps = 2", "steps = 2\ntable = [0, 0.5]")).find("table = [0.0, 0.5]"),
      std::string::npos);
  const std::string probe = "[[probe]]\nname = \"p\"\nset = \"right\"\nstatistic = \"rms_error\"\n";
  EXPECT_NE(resolved(in_mm + probe + "expected = [\"0.5*load\", \"1 um\"]")
                .find(R"(expected = ["5e-04*load", "1e-06"])"),
            std::string::npos);
  EXPECT_NE(resolved(in_mm + probe + "field = \"stress\"\ncomponent = \"xx\"\nexpected = [3]")
                .find("expected = [\"3e+06\"]"),
            std::string::npos)
      << refusal(in_mm + probe + "field = \"stress\"\ncomponent = \"xx\"\nexpected = [3]");
}

TEST_F(Units, LeaveDefaultsAndNumbersWithoutDimensionAlone) {
  const Case plain = read(with(statics, "thickness = 0.0025\n", ""));
  const Case scaled = read(with(in_mm, "thickness = 2.5\n", ""));
  EXPECT_EQ(std::get<Lattice>(scaled.body).cross_section, 1.0);
  EXPECT_EQ(scaled.as_resolved, plain.as_resolved);
  EXPECT_EQ(read(with(in_mm, "angle = 0.0", "angle = 30")).material.damage.rate, 3.0);
  EXPECT_EQ(std::get<Lattice>(read(with(in_mm, "angle = 0.0", "angle = 30")).body).angle, 30.0);
  EXPECT_EQ(std::get<Lattice>(read(with(in_mm, "angle = 0.0", "angle = \"0.5 rad\"")).body).angle,
            28.64788975654116);
}

TEST_F(Units, HoldForOverrides) {
  const auto spacing = [&](const std::string& text, const std::string& value) {
    return double(std::get<Lattice>(read(text, {{"lattice.spacing", value}}).body).spacing);
  };
  EXPECT_EQ(spacing(statics, "2.5 mm"), 0.0025);
  EXPECT_EQ(spacing(statics, "\"2.5 mm\""), 0.0025);
  EXPECT_EQ(spacing(statics, "2.5e-3"), 0.0025);
  EXPECT_EQ(spacing(in_mm, "2.5"), 0.0025);
  EXPECT_EQ(spacing(in_mm, "2.5 m"), 2.5);
  EXPECT_EQ(double(std::get<Lattice>(
                       read(statics, {{"units.length", "um"}, {"lattice.spacing", "7"}}).body)
                       .spacing),
            7e-6);
  expect_refusal(statics, {"--set lattice.spacing=5 MPa", "must be a length, e.g. 2.5 mm"},
                 {{"lattice.spacing", "5 MPa"}});
}

TEST_F(Units, OfThePointFileAreThatOfLength) {
  std::ofstream(folder_ / "points.csv") << "x,y,volume\n0,0,1\n";
  const std::string text =
      "dimension = 2\n[points]\nfile = \"points.csv\"\nhorizon = 3\n[material]\nyoungs_modulus = "
      "1\n";
  const auto source = [&](const std::string& given) {
    return std::get<PointSource>(read(given).body);
  };
  EXPECT_EQ(source(text).length_unit, 1.0);
  const std::string units = "[units]\nlength = \"mm\"\n";
  EXPECT_EQ(source(text + units).length_unit, 0.001);
  EXPECT_EQ(source(text + units).horizon.length, 0.003);
  EXPECT_NE(resolved(text + units).find("length_unit = 0.001"), std::string::npos);
  EXPECT_EQ(resolved(resolved(text + units)), resolved(text + units));
  const std::string own = with(text, "horizon", "length_unit = \"1 um\"\nhorizon");
  EXPECT_EQ(source(own).length_unit, 1e-6);
  EXPECT_EQ(source(own + units).length_unit, 1e-6);
}

TEST_F(Units, ThatAreWrongAreRefusedWithPlaceKeyValueAndWhatIsExpected) {
  const auto spacing = [](const std::string& value) {
    return with(statics, "spacing = [0.001, 0.0007]", "spacing = " + value);
  };
  expect_refusal(spacing("\"2.5 MPa\""),
                 {"study.toml:3:1: lattice.spacing = \"2.5 MPa\": must be a length, e.g. 2.5 mm; "
                  "MPa is the unit of a stress"});
  expect_refusal(spacing("[\"1 mm\", \"2 s\"]"),
                 {"study.toml:3:", "lattice.spacing[1] = \"2 s\"", "is the unit of a time"});
  expect_refusal(spacing("\"5 furlongs\""), {"there is no unit \"furlongs\"", "a length, e.g."});
  expect_refusal(spacing("\"1 MM\""), {"there is no unit \"MM\"; did you mean mm or Mm?"});
  expect_refusal(spacing("\"1e400 m\""), {"\"1e400 m\": is too large or too small for a number"});
  for (const char* value : {"\"mm\"", "\"nan m\"", "\"inf\"", "\"\"", "\"2.5\""})
    expect_refusal(spacing(value), {"must be a positive number [m], not a string"});
  for (const char* value : {"\"1 m m\"", "\"0x10 m\"", "\"2,5 mm\"", "\"1 mm * load\"", "\"1 m2\""})
    expect_refusal(spacing(value), {"must be a length, e.g. 2.5 mm"});
  expect_refusal(spacing("\"-1 mm\""), {"lattice.spacing = \"-1 mm\": must be a positive number"});
  expect_refusal(spacing("2.5 mm"), {"not valid TOML",
                                     "write a number with a unit in quotes: "
                                     "\"2.5 mm\""});
  expect_refusal(with(statics, "steps = 2", "steps = \"2 mm\""), {"must be a whole number"});
  expect_refusal(with(statics, "density = 7850.0", "density = \"2.4 kg\""),
                 {"a density, e.g. 2.4 t/m3; kg is the unit of a mass"});
  expect_refusal(
      with(statics, "5e+06*load", "5 mm*load"),
      {"load[1].pressure = \"5 mm*load\"", "a value that is a length; must be a stress"});
  expect_refusal(with(statics, "law = \"linear\"", "law = \"linear\"\nhardening = \"1 mm\""),
                 {"must be a number without a unit"});
  expect_refusal(with(in_mm, "strength = 30", "strength = -30"),
                 {"material.damage.strength = -30: must be a positive number [Pa]"});
}

TEST_F(Units, OfTheTableMustAgree) {
  const auto units = [](const std::string& lines) { return statics + "[units]\n" + lines + "\n"; };
  EXPECT_EQ(
      refusal(units("length = \"mm\"\nforce = \"N\"\nstress = \"MPa\"\nmass = \"t\"\nenergy = "
                    "\"mJ\"\ntime = \"s\"")),
      "");
  expect_refusal(units("length = \"mm\"\nforce = \"N\"\nstress = \"GPa\""),
                 {"units.stress = \"GPa\": does not agree with the other units", "1e+06 Pa"});
  expect_refusal(units("length = \"mm\"\nmass = \"kg\"\nforce = \"N\""), {"units.mass", "1000 kg"});
  expect_refusal(units("length = \"MPa\""),
                 {"units.length = \"MPa\": must be the unit of a length, not of a stress"});
  expect_refusal(units("length = \"furlong\""), {"there is no unit \"furlong\""});
  expect_refusal(units("length = 1e-3"), {"units.length = 1e-3: must be a string"});
  expect_refusal(units("lenght = \"mm\""), {"units.lenght", "did you mean length?"});
  expect_refusal("units = 3\n" + statics, {"units = 3: must be a table"});
}

TEST(UnitSystemOfNames, FollowsFromWhatIsGiven) {
  const auto size = [](const UnitNames& names, const char* of) {
    return unit_system(names).unit_of(unit_of_key(of).dimension).size();
  };
  const UnitNames by_force{.length = "mm", .time = "ms", .force = "kN"};
  EXPECT_DOUBLE_EQ(size(by_force, "Pa"), 1e9);
  EXPECT_DOUBLE_EQ(size(by_force, "kg"), 1.0);
  EXPECT_DOUBLE_EQ(size(by_force, "J/m2"), 1e6);
  EXPECT_DOUBLE_EQ(size(by_force, "Pa*sqrt(m)"), 1e9 * std::sqrt(1e-3));
  EXPECT_DOUBLE_EQ(size({.length = "mm", .stress = "MPa"}, "N"), 1.0);
  EXPECT_DOUBLE_EQ(size({.length = "mm", .energy = "mJ"}, "N"), 1.0);
  EXPECT_DOUBLE_EQ(size({.length = "mm", .mass = "kg"}, "N"), 1e-3);
  EXPECT_DOUBLE_EQ(size({.length = "mm"}, "N"), 1.0);
  EXPECT_DOUBLE_EQ(size({}, "kg/m3"), 1.0);
  EXPECT_DOUBLE_EQ(size({.length = "in", .force = "lbf"}, "Pa"), 6894.757293168361);
  EXPECT_TRUE(unit_system({}).is_si());
  EXPECT_FALSE(unit_system(by_force).is_si());
}

}  // namespace
}  // namespace peristat
