#include "cases/runner/setup/preflight.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cases/runner/setup/body.hpp"
#include "cases/runner/setup/preflight_rules.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

namespace fs = std::filesystem;

/// A plate of 20 x 10 points that a slit of two rows of four points notches from its left side.
const std::string plate = R"(dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [0.02, 0.01]
[[lattice.shape]]
subtract = "box"
min = [0, 4e-3]
max = [4e-3, 6e-3]
SLIT
[[lattice.layer]]
name = "bottom"
side = "y-"
[[lattice.layer]]
name = "top"
side = "y+"
CRACK
[material]
youngs_modulus = 70e9
[material.damage]
law = "linear"
fracture_energy = 10.0
[[support]]
set = "bottom"
displacement = [0, 0]
[[support]]
set = "top"
displacement = [0, "LIFT"]
[loading]
steps = 10
)";

std::string replaced(std::string text, const std::string& part, const std::string& by) {
  const auto at = text.find(part);
  if (at == std::string::npos) throw std::logic_error("no " + part);
  return text.replace(at, part.size(), by);
}

/// The plate as it is meant: nothing in it is odd.
std::string right_plate() {
  return replaced(replaced(replaced(plate, "SLIT", "cuts_bonds = true"), "CRACK", ""), "LIFT",
                  "1e-6*load");
}

class PreflightOf : public testing::Test {
 protected:
  PreflightOf()
      : folder_(fs::temp_directory_path() /
                ("peristat_preflight_" + std::to_string(std::random_device{}()))) {
    fs::create_directories(folder_);
  }
  ~PreflightOf() override { fs::remove_all(folder_); }

  [[nodiscard]] Preflight facts(const std::string& text) const {
    std::ofstream(folder_ / "case.toml") << text;
    const Case from = read_case(folder_ / "case.toml");
    const std::unique_ptr<const Body> body = make_body(from, 1);
    return located_errors(from, [&] { return preflight_of(from, *body, SoleRank()); });
  }
  [[nodiscard]] std::vector<std::string> warnings(const std::string& text) const {
    return warnings_of(facts(text));
  }
  [[nodiscard]] std::string refusal(const std::string& text) const {
    try {
      static_cast<void>(facts(text));
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
  /// That there is one warning, with these words.
  void expect_one(const std::string& text, const std::vector<std::string>& words) const {
    const std::vector<std::string> told = warnings(text);
    ASSERT_EQ(told.size(), 1U) << (told.empty() ? "none" : told.back());
    for (const std::string& word : words) {
      EXPECT_NE(told[0].find(word), std::string::npos) << word << " in " << told[0];
    }
  }

  fs::path folder_;
};

TEST_F(PreflightOf, APlateAsItIsMeantHasNoWarning) {
  EXPECT_EQ(warnings(right_plate()), std::vector<std::string>());
}

TEST_F(PreflightOf, TellsLengthsOfTheBodyAndOfWhatIsLeft) {
  const Preflight of = facts(right_plate());
  ASSERT_EQ(of.extents.size(), 2U);
  EXPECT_DOUBLE_EQ(of.extents[0], 0.02);
  EXPECT_DOUBLE_EQ(of.extents[1], 0.01);
  EXPECT_DOUBLE_EQ(of.cross_section, 1e-3);
  const auto* const ligament = of.shortest(FeatureLength::Kind::ligament);
  const auto* const opening = of.shortest(FeatureLength::Kind::opening);
  ASSERT_TRUE(ligament != nullptr && opening != nullptr);
  EXPECT_NEAR(ligament->size, 4e-3, 1e-12);  // above and below the slit
  EXPECT_NEAR(opening->size, 2e-3, 1e-12);
}

TEST_F(PreflightOf, TellsValuesAtTheBeginningAndTheEnd) {
  const Preflight of = facts(right_plate());
  const auto lift =
      std::ranges::find(of.applied, "support[1].displacement[1]", &Preflight::Applied::key);
  ASSERT_NE(lift, of.applied.end());
  EXPECT_TRUE(lift->changes);
  EXPECT_EQ(lift->begin[1], 0.0);
  EXPECT_DOUBLE_EQ(lift->end[0], 1e-6);
}

TEST_F(PreflightOf, BondsThatBridgeASlitAreCounted) {
  // Within 3.015 spacings a bond crosses two missing rows straight only: 3 up, at each of the four
  // columns; slanted ones are longer.
  const std::string text = replaced(right_plate(), "cuts_bonds = true", "");
  const Preflight of = facts(text);
  ASSERT_EQ(of.openings.size(), 1U);
  EXPECT_EQ(of.openings[0].bridging, 4);
  expect_one(text, {"4 bonds bridge lattice.shape[1]", "cuts_bonds = true"});
}

TEST_F(PreflightOf, AShapeThatCutsLeavesNoBondAcrossIt) {
  const std::string text = right_plate();
  std::ofstream(folder_ / "case.toml") << text;
  const Case from = read_case(folder_ / "case.toml");
  const auto body = make_body(from, 1);
  EXPECT_GE(body->cut_bonds.size(), 4U);
  const Shape slit = std::get<Lattice>(from.body).shapes[1].shape;
  const Bonds& bonds = body->model.bonds();
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      EXPECT_EQ(length_inside(slit, 2, body->points.position(i),
                              body->points.position(bonds.partner(i, bond))),
                0.0);
    }
  }
  EXPECT_NE(from.as_resolved.find("cuts_bonds = true"), std::string::npos);
}

TEST_F(PreflightOf, ACrackIsToldWithTheBondsThatItCuts) {
  const std::string crack = "[[crack]]\nfrom = [0.015, 5e-3]\nto = [0.03, 5e-3]";
  const std::string text = replaced(plate, "CRACK", crack);
  const Preflight of =
      facts(replaced(replaced(text, "SLIT", "cuts_bonds = true"), "LIFT", "1e-6*load"));
  ASSERT_EQ(of.cracks.size(), 1U);
  EXPECT_GT(of.cracks[0].bonds, 30);
}

TEST_F(PreflightOf, ACrackThatCutsNothingIsRefused) {
  const std::string text =
      replaced(replaced(plate, "SLIT", "cuts_bonds = true"), "LIFT", "1e-6*load");
  const std::string outside =
      refusal(replaced(text, "CRACK", "[[crack]]\nfrom = [5, 5]\nto = [6, 5]"));
  EXPECT_NE(outside.find("crack[0]"), std::string::npos) << outside;
  EXPECT_NE(outside.find("cuts no bond"), std::string::npos) << outside;
}

TEST_F(PreflightOf, ACrackInTheMiddleOfAWideNotchMayCutNothing) {
  std::string text = replaced(right_plate(), "cuts_bonds = true", "");
  text = replaced(text, "spacing = 1e-3", "spacing = 0.5e-3");
  text = replaced(text, "[material]\n",
                  "[[crack]]\nfrom = [0, 5e-3]\nto = [3e-3, 5e-3]\n[material]\n");
  EXPECT_EQ(refusal(text), "");
  EXPECT_EQ(facts(text).cracks[0].bonds, 0);
}

TEST_F(PreflightOf, AShapeThatTakesNothingAwayIsRefused) {
  const std::string far = replaced(right_plate(), "max = [4e-3, 6e-3]", "max = [0.4e-3, 6e-3]");
  const std::string told = refusal(replaced(far, "min = [0, 4e-3]", "min = [0, 5.6e-3]"));
  EXPECT_NE(told.find("lattice.shape[1].subtract"), std::string::npos) << told;
  EXPECT_NE(told.find("has no effect"), std::string::npos) << told;
}

TEST_F(PreflightOf, ADisplacementThatIsThereAtOnce) {
  expect_one(replaced(right_plate(), "1e-6*load", "1e-6"),
             {"support[1].displacement[1] = 1e-6", "applied in full at load 0", "\"1e-6*load\""});
}

TEST_F(PreflightOf, ADeadLoadBesideOneThatGrowsIsMeant) {
  const std::string dead = "[[load]]\nset = \"top\"\ntotal_force = [1.0, 0]\n";
  EXPECT_EQ(warnings(right_plate() + dead), std::vector<std::string>());
}

TEST_F(PreflightOf, NothingIsApplied) {
  expect_one(replaced(right_plate(), "1e-6*load", "0*load"), {"nothing is applied"});
}

TEST_F(PreflightOf, AThicknessThatIsMissing) {
  expect_one(replaced(right_plate(), "thickness = 1e-3\n[[", "[["),
             {"lattice.thickness is not given", "1 m"});
  expect_one(replaced(right_plate(), "thickness = 1e-3\n[[", "thickness = 10\n[["),
             {"lattice.thickness = 10 m"});
}

TEST_F(PreflightOf, ASpacingThatDoesNotDivideTheBody) {
  // The slit's edges lie where the first cells' do.
  expect_one(replaced(right_plate(), "max = [0.02, 0.01]", "max = [0.0203, 0.01]"),
             {"along x", "0.0203 m become 20 spacings, 0.02 m"});
}

TEST_F(PreflightOf, AHorizonBeyondALigament) {
  expect_one(
      replaced(replaced(right_plate(), "[0, 4e-3]", "[0, 3e-3]"), "[4e-3, 6e-3]", "[18e-3, 6e-3]"),
      {"the horizon", "larger than the ligament beside lattice.shape[1], 0.002 m"});
}

TEST_F(PreflightOf, AModulusInOtherUnits) {
  const std::string text =
      replaced(right_plate(), "fracture_energy = 10.0", "critical = 2e-3\nonset = 1e-3");
  expect_one(replaced(text, "70e9", "30"), {"material.youngs_modulus = 30 Pa", "30e9"});
  const std::vector<std::string> soft = warnings(replaced(right_plate(), "70e9", "30e3"));
  ASSERT_EQ(soft.size(), 1U);
  EXPECT_NE(soft[0].find("30 GPa and 30000 MPa are 30e9"), std::string::npos) << soft[0];
}

TEST_F(PreflightOf, AProcessZoneThatIsTooShort) {
  // As it comes the law gives the body 9.91 MPa: 1.7 times that is beyond what was measured.
  const Preflight as_it_comes = facts(right_plate());
  ASSERT_EQ(as_it_comes.fractures.size(), 1U);
  EXPECT_NEAR(as_it_comes.fractures[0].characteristic_length() / as_it_comes.horizon, 2.363, 0.01);
  const double strength = 1.7 * as_it_comes.fractures[0].strength;
  expect_one(replaced(right_plate(), "fracture_energy = 10.0",
                      "fracture_energy = 10.0\nstrength = " + std::to_string(strength)),
             {"coarse for the process zone", "horizons"});
}

TEST_F(PreflightOf, AStrengthThatIsMissingWhereNoNotchIs) {
  std::string text = right_plate();
  const auto begin = text.find("[[lattice.shape]]\nsubtract");
  text.erase(begin, text.find("[[lattice.layer]]") - begin);
  expect_one(text, {"material.damage.strength is missing", "MPa"});
}

TEST_F(PreflightOf, KeysWithoutWhatUsesThem) {
  expect_one(replaced(right_plate(), "thickness = 1e-3\n[[", "thickness = 1e-3\nseed = 2\n[["),
             {"lattice.seed is not used"});
  // What a resolved text has of every key is no slip.
  EXPECT_EQ(warnings(right_plate() + "[relaxation]\nsteps = 10\n[output]\ncount_cracks = false\n"),
            std::vector<std::string>());
}

}  // namespace
}  // namespace peristat
