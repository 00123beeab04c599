#include "cases/runner/input/case.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

namespace fs = std::filesystem;
using Overrides = std::vector<std::pair<std::string, std::string>>;

class CaseFolder : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("peristat_case_" + std::to_string(std::random_device{}()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& text, const std::string& name = "study.toml") const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  Case read(const std::string& text, const Overrides& overrides = {}) const {
    return read_case(write(text), overrides);
  }
  /// Message of the refusal, the folder's name cut out; empty if the case is accepted.
  std::string refusal(const std::string& text, const Overrides& overrides = {}) const {
    return refusal_of_file(write(text), overrides);
  }
  std::string refusal_of_file(const fs::path& file, const Overrides& overrides = {}) const {
    try {
      static_cast<void>(read_case(file, overrides));
    } catch (const InputError& error) {
      std::string message = error.what();
      for (const std::string prefix = folder_.string() + "/";;) {
        const auto at = message.find(prefix);
        if (at == std::string::npos) return message;
        message.erase(at, prefix.size());
      }
    }
    return {};
  }

  fs::path folder_;
};

using CaseReader = CaseFolder;
using CaseOverride = CaseFolder;
using CaseText = CaseFolder;
using CaseLocations = CaseFolder;
using CaseDocumentation = CaseFolder;
using ShippedCases = CaseFolder;

const std::string bar = R"(dimension = 1
[lattice]
spacing = 0.1
area = 1e-6
[[lattice.shape]]
add = "box"
min = [0]
max = [1]
[[lattice.layer]]
name = "left"
side = "x-"
[material]
youngs_modulus = 200e9
[[support]]
set = "left"
displacement = [0]
)";

// The tests below count on these line numbers.
const std::string plate = R"(title = "Plate"
dimension = 2
[lattice]
spacing = 0.1
horizon_ratio = 3.015
thickness = 0.1
[[lattice.shape]]
add = "box"
min = [0.0, 0.0]
max = [1.0, 0.5]
[[lattice.layer]]
name = "left"
side = "x-"
[[set]]
name = "right"
where = "x > 0.9"
[material]
youngs_modulus = 1.92e11
[[support]]
set = "left"
displacement = [0, "1e-3*load"]
[[load]]
set = "right"
body_force = ["1e6*load", 0]
[[probe]]
name = "tip"
set = "right"
)";

const std::string beam = R"(dimension = 3
[lattice]
spacing = 0.1
origin = "nodes"
perturbation = 0.2
seed = 7
[[lattice.shape]]
add = "box"
min = [0, 0, 0]
max = [1, 0.5, 0.5]
[[lattice.shape]]
subtract = "cylinder"
centre = [0.5, 0.25, 0.25]
radius = 0.1
[[lattice.shape]]
subtract = "sphere"
centre = [0.8, 0.25, 0.25]
radius = 0.05
[[lattice.shape]]
subtract = "polygon"
vertices = [[0, 0], [0.1, 0], [0, 0.1]]
[[lattice.layer]]
name = "left"
side = "x-"
thickness = 2
where = "y > 0.1"
[[set]]
name = "inner"
where = "z < 0.3"
shape = { sphere = { centre = [0.5, 0.2, 0.2], radius = 0.2 } }
[quadrature]
volume_correction = "linear"
surface_correction = "energy"
[material]
micromodulus = 1e20
density = 7850
[[support]]
set = "left"
displacement = [0, "free", "1e-3*load*x"]
[[load]]
set = "inner"
total_force = [0, 0, "-100*load"]
[loading]
steps = 4
adaptive = false
[output]
every = 2
)";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("no '" + from + "' to replace");
  return text.replace(at, from.size(), to);
}

TEST_F(CaseReader, ReadsABar) {
  const Case read_bar = read(bar);
  const auto& lattice = std::get<Lattice>(read_bar.body);
  EXPECT_EQ(read_bar.title, "study");
  EXPECT_EQ(read_bar.dimension, 1);
  EXPECT_EQ(lattice.dimension, 1);
  EXPECT_EQ(lattice.spacing, 0.1);
  EXPECT_EQ(lattice.cross_section, 1e-6);
  ASSERT_EQ(lattice.shapes.size(), 1u);
  EXPECT_EQ(std::get<Box>(lattice.shapes[0].shape).max[0], 1.0);
  ASSERT_EQ(lattice.layers.size(), 1u);
  EXPECT_EQ(lattice.layers[0].side.axis, 0);
  EXPECT_EQ(lattice.layers[0].side.sign, -1);
  EXPECT_EQ(lattice.layers[0].thickness, 3);
  EXPECT_EQ(read_bar.horizon_ratio, 3.015);
  EXPECT_EQ(read_bar.material.youngs_modulus, 200e9);
  EXPECT_FALSE(read_bar.material.micromodulus);
  ASSERT_EQ(read_bar.supports.size(), 1u);
  EXPECT_EQ(read_bar.supports[0].displacement[0], "0");
  EXPECT_FALSE(read_bar.supports[0].displacement[1]);
  EXPECT_EQ(read_bar.loading.largest_step, 1.0);
  EXPECT_EQ(read_bar.as_read, bar);
}

TEST_F(CaseReader, ReadsAPlate) {
  const Case read_plate = read(plate);
  EXPECT_EQ(read_plate.title, "Plate");
  EXPECT_EQ(std::get<Lattice>(read_plate.body).cross_section, 0.1);
  ASSERT_EQ(read_plate.sets.size(), 1u);
  EXPECT_EQ(read_plate.sets[0].where, "x > 0.9");
  EXPECT_EQ(read_plate.supports.at(0).displacement[1], "1e-3*load");
  EXPECT_EQ(read_plate.loads.at(0).kind, LoadSpecification::Kind::body_force);
  EXPECT_EQ(read_plate.loads.at(0).value[0], "1e6*load");
  EXPECT_EQ(read_plate.probes.at(0).field, "displacement");
  const std::string folder = folder_.filename().string();
  EXPECT_EQ(read_plate.output.directory, fs::path("results") / (folder + "_study"));
}

TEST_F(CaseReader, ReadsABeam) {
  const Case read_beam = read(beam);
  const auto& lattice = std::get<Lattice>(read_beam.body);
  EXPECT_EQ(lattice.origin, LatticeOrigin::nodes);
  EXPECT_EQ(lattice.perturbation, 0.2);
  EXPECT_EQ(lattice.seed, 7u);
  ASSERT_EQ(lattice.shapes.size(), 4u);
  EXPECT_EQ(lattice.shapes[1].action, ShapeStep::Action::subtract);
  EXPECT_EQ(std::get<Cylinder>(lattice.shapes[1].shape).axis[2], 1.0);
  EXPECT_EQ(std::get<Polygon>(lattice.shapes[3].shape).vertices.size(), 3u);
  EXPECT_EQ(std::get<Sphere>(read_beam.sets.at(0).shape.value()).radius, 0.2);
  EXPECT_EQ(read_beam.volume_correction, VolumeCorrection::linear);
  EXPECT_EQ(read_beam.surface_correction, SurfaceCorrection::energy);
  EXPECT_EQ(read_beam.material.micromodulus, 1e20);
  EXPECT_EQ(read_beam.material.density, 7850.0);
  EXPECT_FALSE(read_beam.supports.at(0).displacement[1]);
  EXPECT_EQ(read_beam.loads.at(0).kind, LoadSpecification::Kind::total_force);
  EXPECT_FALSE(read_beam.loading.adaptive);
  EXPECT_EQ(read_beam.loading.largest_step, 0.25);
  EXPECT_EQ(read_beam.output.every, 2);
}

const std::string cloud = R"(dimension = 2
[points]
file = "cloud.csv"
horizon = 0.3
thickness = 0.01
[material]
youngs_modulus = 1e9
[[support]]
set = "named_in_the_file"
displacement = [0, 0]
)";

TEST_F(CaseReader, ReadsAPointSourceRelativeToTheCaseFile) {
  write("x, y, volume\n", "cloud.csv");
  const Case read_cloud = read(cloud);
  const auto& source = std::get<PointSource>(read_cloud.body);
  EXPECT_EQ(source.file, folder_ / "cloud.csv");
  EXPECT_EQ(source.horizon.length, 0.3);
  EXPECT_EQ(source.cross_section, 0.01);
}

// ---- Refusals

struct BadInput {
  std::string name;
  std::string from, to;  ///< what is replaced in the plate
  int line;
  std::vector<std::string> fragments;  ///< of the message
};

void PrintTo(const BadInput& bad, std::ostream* out) { *out << bad.name; }

class CaseRefusal : public CaseFolder, public testing::WithParamInterface<BadInput> {};

TEST_P(CaseRefusal, NamesLineAndReason) {
  const BadInput& bad = GetParam();
  const std::string message = refusal(with(plate, bad.from, bad.to));
  const std::string place = "study.toml:" + std::to_string(bad.line) + ":";
  EXPECT_EQ(message.substr(0, place.size()), place) << message;
  for (const auto& fragment : bad.fragments)
    EXPECT_NE(message.find(fragment), std::string::npos) << fragment << "\nis not in\n" << message;
}

const std::vector<BadInput> bad_inputs{
    // unknown keys
    {"UnknownKey",
     "youngs_modulus",
     "yongs_modulus",
     18,
     {"18:1: material.yongs_modulus = 1.92e11: unknown key; did you mean youngs_modulus?  "
      "(allowed: ",
      "micromodulus"}},
    {"UnknownKeyOfAnotherTable",
     "[material]",
     "[material]\nsteps = 3",
     18,
     {"material.steps = 3: unknown key; did you mean arc_length.steps, loading.steps or "
      "relaxation.steps?"}},
    {"SymbolOfAModulus",
     "youngs_modulus",
     "E",
     18,
     {"material.E", "unknown key; the key is youngs_modulus  (allowed: "}},
    {"SymbolOfAToughness",
     "[material]",
     "[material]\nKIc = 1e6",
     18,
     {"material.KIc", "unknown key; the key is material.damage.fracture_toughness"}},
    {"SymbolOfAFractureEnergy",
     "youngs_modulus = 1.92e11",
     "youngs_modulus = 1.92e11\n[material.damage]\nlaw = \"linear\"\nG_f = 10",
     21,
     {"material.damage.G_f", "the key is fracture_energy"}},
    {"BeginningOfAKey",
     "horizon_ratio",
     "horizon",
     5,
     {"lattice.horizon", "did you mean horizon_ratio?"}},
    {"UnknownShapeWithKeysOfItsOwn",
     "add = \"box\"\nmin = [0.0, 0.0]",
     "add = \"oval\"\nsemiaxes = [0.1, 0.2]\nmin = [0.0, 0.0]",
     8,
     {"lattice.shape[0].add = \"oval\"", "not known", "box, disk"}},
    {"PoissonRatioOfBonds",
     "[material]",
     "[material]\npoisson_ratio = 0.2",
     18,
     {"material.poisson_ratio = 0.2", "1/3 in plane stress, 1/4", "\"cpd\", \"state\", \"lps\""}},
    {"TableOfAParameterThatNothingNames",
     "[[probe]]",
     "[loading]\ntable = [0, 1]\ntable2 = [0, 1]\n[[probe]]",
     27,
     {"loading.table2", "gives values of load2, but no displacement and no load uses it"}},
    {"LongName",
     "name = \"tip\"",
     "name = \"" + std::string(300, 't') + "\"",
     26,
     {"probe[0].name", "has 300 characters; at most 100"}},
    {"CutsOfAnAddedShape",
     "add = \"box\"",
     "add = \"box\"\ncuts_bonds = true",
     9,
     {"lattice.shape[0].cuts_bonds", "is for a shape that is subtracted"}},
    {"UnknownInfluence",
     "[material]",
     "[material]\ninfluence = \"septik\"",
     18,
     {"material.influence = \"septik\": not known; did you mean septic?"}},
    {"UnknownTable", "[material]", "[materials]", 17, {"materials", "did you mean material?"}},
    {"UnknownKeyInAnArray",
     "displacement = ",
     "displacements = ",
     21,
     {"support[0].displacements", "did you mean displacement?"}},
    {"UnknownKeyInAShape",
     "where = \"x > 0.9\"",
     "shape = { box = { min = [0, 0], max = [1, 1], mix = 3 } }",
     16,
     {"set[0].shape.box.mix = 3"}},
    {"KeyOfAnotherShape",
     "max = [1.0, 0.5]",
     "max = [1.0, 0.5]\nradius = 3",
     11,
     {"lattice.shape[0].radius = 3", "not a key of the shape box"}},
    // broken TOML
    {"BrokenToml", "spacing = 0.1", "spacing = 0.1.2", 4, {"not valid TOML"}},
    {"NoValue", "horizon_ratio = 3.015", "horizon_ratio =", 5, {"not valid TOML"}},
    {"KeyTwice", "thickness = 0.1", "spacing = 0.2", 6, {"not valid TOML", "spacing"}},
    {"BrokenUtf8",
     "Plate",
     "Pl\xff"
     "te",
     1,
     {"not valid TOML"}},
    // wrong types
    {"StringForNumber",
     "spacing = 0.1",
     "spacing = \"0.1\"",
     4,
     {"lattice.spacing = \"0.1\"", "must be a positive number [m]", "not a string"}},
    {"BooleanForNumber",
     "1.92e11",
     "true",
     18,
     {"material.youngs_modulus = true", "not a boolean"}},
    {"RealForWholeNumber", "dimension = 2", "dimension = 2.5", 2, {"whole number from 1 to 3"}},
    {"RealBeyondWholeNumbers", "dimension = 2", "dimension = 1e300", 2, {"whole number"}},
    {"NumberForString", "title = \"Plate\"", "title = 3", 1, {"must be a string"}},
    {"NumberForBoolean",
     "[material]",
     "[loading]\nadaptive = 1\n[material]",
     18,
     {"loading.adaptive = 1", "true or false"}},
    {"DateForString", "\"Plate\"", "2020-01-01", 1, {"not a date"}},
    {"NumberForArray", "min = [0.0, 0.0]", "min = 0.0", 9, {"array of 2 numbers"}},
    {"TableForArrayOfTables", "[[support]]", "[support]", 19, {"write [[support]]"}},
    {"ArrayOfTablesForTable", "[material]", "[[material]]", 17, {"write [material]"}},
    {"NumberForTable", "title = \"Plate\"", "quadrature = 3", 1, {"must be a table"}},
    {"StringInNumbers", "[1.0, 0.5]", "[1.0, \"0.5\"]", 10, {"lattice.shape[0].max[1] = \"0.5\""}},
    {"ArrayAsComponent", "[0, \"1e-3*load\"]", "[0, [1]]", 21, {"support[0].displacement[1]"}},
    // numbers out of range
    {"NegativeSpacing",
     "spacing = 0.1",
     "spacing = -0.1",
     4,
     {"lattice.spacing = -0.1: must be a positive number [m]"}},
    {"ZeroSpacing", "spacing = 0.1", "spacing = 0", 4, {"lattice.spacing = 0: must be a positive"}},
    {"TinySpacing", "spacing = 0.1", "spacing = 1e-300", 4, {"from 1e-30 to 1e+30"}},
    {"HugeCoordinate", "[1.0, 0.5]", "[1e300, 0.5]", 10, {"from -1e+30 to 1e+30"}},
    {"NotANumber", "1.92e11", "nan", 18, {"material.youngs_modulus = nan: must be a positive"}},
    {"Infinity", "1.92e11", "inf", 18, {"material.youngs_modulus = inf: must be a positive"}},
    {"ZeroConstant", "1.92e11", "0.0", 18, {"must be a positive number [Pa]"}},
    {"NegativeConstant", "1.92e11", "-5", 18, {"must be a positive number [Pa]"}},
    {"ZeroMicromodulus", "youngs_modulus = 1.92e11", "micromodulus = 0", 18, {"N/m6"}},
    {"ZeroDensity", "[material]", "[material]\ndensity = 0", 18, {"positive number [kg/m3]"}},
    {"ZeroThickness", "thickness = 0.1", "thickness = 0", 6, {"positive number [m]"}},
    {"InfiniteCoordinate", "[1.0, 0.5]", "[inf, 0.5]", 10, {"must be a finite number"}},
    {"NotANumberAsComponent", "[0, \"1e-3*load\"]", "[nan, 0]", 21, {"must be a finite number"}},
    {"SmallHorizon",
     "3.015",
     "0.9",
     5,
     {"lattice.horizon_ratio = 0.9: the horizon is smaller than the spacing"}},
    {"WrongDimension", "dimension = 2", "dimension = 4", 2, {"from 1 to 3"}},
    {"LargePerturbation", "[lattice]", "[lattice]\nperturbation = 0.5", 4, {"from 0 to 0.49"}},
    {"NegativeSeed", "[lattice]", "[lattice]\nseed = -1", 4, {"lattice.seed = -1"}},
    {"ThinLayer", "side = \"x-\"", "side = \"x-\"\nthickness = 0", 14, {"from 1 to"}},
    {"NoSteps", "[material]", "[loading]\nsteps = 0\n[material]", 18, {"from 1 to 1000000"}},
    {"LargestStepBelowFirst",
     "[material]",
     "[loading]\nlargest_step = 0.5\n[material]",
     18,
     {"1 / steps"}},
    {"SmallestStepAboveFirst",
     "[material]",
     "[loading]\nsteps = 10\nsmallest_step = 0.5\n[material]",
     19,
     {"1 / steps"}},
    {"LooseTolerance",
     "[material]",
     "[solver]\nrelative_tolerance = 0.1\n[material]",
     18,
     {"from 1e-14 to 0.01"}},
    {"NoIterations", "[material]", "[solver]\nmax_iterations = 0\n[material]", 18, {"1 to 1000"}},
    {"EveryZeroth", "[material]", "[output]\nevery = 0\n[material]", 18, {"output.every = 0"}},
    {"NoDirectory", "[material]", "[output]\ndirectory = \"\"\n[material]", 18, {"is empty"}},
    {"EmptyBox", "[1.0, 0.5]", "[1.0, 0.0]", 10, {"lattice.shape[0].max", "larger than min"}},
    // numbers of components
    {"TooFewComponents", "[1.0, 0.5]", "[1.0]", 10, {"array of 2 numbers", "not 1"}},
    {"TooManyComponents", "[0, \"1e-3*load\"]", "[0, 0, 0]", 21, {"of 2 numbers or", "not 3"}},
    {"EmptyArray", "[0, \"1e-3*load\"]", "[]", 21, {"is empty"}},
    // missing
    {"MissingKey", "spacing = 0.1\n", "", 3, {"lattice.spacing: this key is missing"}},
    {"MissingKeyInAnArray",
     "displacement = [0, \"1e-3*load\"]",
     "",
     19,
     {"support[0].displacement: this key is missing"}},
    {"MissingTable",
     "[material]\nyoungs_modulus = 1.92e11\n",
     "",
     1,
     {"material: this table is missing"}},
    {"MissingShape",
     "[[lattice.shape]]\nadd = \"box\"\nmin = [0.0, 0.0]\nmax = [1.0, 0.5]\n",
     "",
     3,
     {"lattice.shape", "at least one shape"}},
    {"NoConstant",
     "youngs_modulus = 1.92e11",
     "",
     17,
     {"exactly one of youngs_modulus, micromodulus"}},
    {"TwoConstants",
     "[material]",
     "[material]\nmicromodulus = 1e20",
     18,
     {"can't be given together with youngs_modulus"}},
    {"NoForce", "body_force = [\"1e6*load\", 0]", "", 22, {"load[0]", "exactly one of body_force"}},
    {"TwoBodies",
     "[material]",
     "[points]\nfile = \"a.csv\"\n[material]",
     17,
     {"points", "can't be given together with lattice"}},
    {"SetWithoutRule", "where = \"x > 0.9\"", "", 14, {"set[0]: needs where or shape"}},
    {"TwoShapesInASet",
     "where = \"x > 0.9\"",
     "shape = { box = { min = [0, 0], max = [1, 1] }, disk = { centre = [0, 0], radius = 1 } }",
     16,
     {"exactly one of"}},
    // names out of a list
    {"WrongModel",
     "[material]",
     "[material]\nmodel = \"bnd\"",
     18,
     {"material.model = \"bnd\": not known; did you mean bond?  (allowed: bond, cpd, state, lps, "
      "green_bond, correspondence)"}},
    {"CpdConstantOfABondModel",
     "[material]",
     "[material]\nc2 = 1.0",
     18,
     {"material.c2", "is for model \"cpd\""}},
    {"CpdWithoutPoissonRatio", "[material]", "[material]\nmodel = \"cpd\"", 17, {"poisson_ratio"}},
    {"CpdWithTooMuch",
     "[material]",
     "[material]\nmodel = \"cpd\"\nc1 = 1.0",
     19,
     {"can't be given together with youngs_modulus"}},
    {"CpdInTwoDimensionsWithModuliAndC2",
     "[material]",
     "[material]\nmodel = \"cpd\"\npoisson_ratio = 0.4\nc2 = 1.0",
     20,
     {"material.c2", "follows from"}},
    {"CpdPoissonRatio",
     "[material]",
     "[material]\nmodel = \"cpd\"\npoisson_ratio = 1.5",
     19,
     {"material.poisson_ratio"}},
    {"CpdWithSurfaceCorrection",
     "[material]",
     "[quadrature]\nsurface_correction = \"energy\"\n[material]\nmodel = \"cpd\"\npoisson_ratio = "
     "0.4",
     18,
     {"quadrature.surface_correction", "is for models \"bond\" and \"state\""}},
    {"WeightsOfABondModel",
     "[material]",
     "[quadrature]\nweights = \"mean\"\n[material]",
     18,
     {"quadrature.weights", "is for model \"cpd\""}},
    {"AxisOfAMean",
     "name = \"tip\"",
     "name = \"tip\"\naxis = \"x\"",
     27,
     {"axis", "poisson_ratio"}},
    {"DampingOfTheFlow",
     "[material]",
     "[relaxation]\nmethod = \"flow\"\ndamping = \"kinetic\"\n[material]",
     19,
     {"relaxation.damping", "is for method = \"dynamic\""}},
    {"RampOfTheFlow",
     "[material]",
     "[relaxation]\nmethod = \"flow\"\nramp = 5\n[material]",
     19,
     {"relaxation.ramp"}},
    {"MovingLoadOfTheFlow",
     "[material]",
     "[relaxation]\nmethod = \"flow\"\nload = \"moving\"\n[material]",
     19,
     {"relaxation.load"}},
    {"MassOfTheFlow",
     "[material]",
     "[relaxation]\nmethod = \"flow\"\nmass_factor = 2\n[material]",
     19,
     {"relaxation.mass_factor"}},
    {"QuietIterationsOfTheFlow",
     "[material]",
     "[relaxation]\nmethod = \"flow\"\nquiet_iterations = 5\n[material]",
     19,
     {"relaxation.quiet_iterations"}},
    {"SettledStatesOfTheFlow",
     "[material]",
     "[relaxation]\nmethod = \"flow\"\ndisplacement_tolerance = 1e-9\n[material]",
     19,
     {"relaxation.displacement_tolerance"}},
    {"FlowToleranceOfDynamicRelaxation",
     "[material]",
     "[relaxation]\nflow_tolerance = 0.1\n[material]",
     18,
     {"relaxation.flow_tolerance", "is for method = \"flow\""}},
    {"TooLooseAFlow",
     "[material]",
     "[relaxation]\nmethod = \"flow\"\nflow_tolerance = 0.6\n[material]",
     19,
     {"relaxation.flow_tolerance", "0.5"}},
    {"PeakOfAnotherMode",
     "[material]",
     "[relaxation]\npeak_tolerance = 1e-3\n[material]",
     18,
     {"relaxation.peak_tolerance", "is for mode \"adaptive\""}},
    {"WrongMode",
     "[material]",
     "[solver]\nmode = \"explicit\"\n[material]",
     18,
     {"allowed: newton, relaxation, adaptive"}},
    {"WrongLinear",
     "[material]",
     "[solver]\nlinear = \"choleski\"\n[material]",
     18,
     {"did you mean cholesky?", "auto, cholesky"}},
    {"WrongOrigin",
     "[lattice]",
     "[lattice]\norigin = \"node\"",
     4,
     {"did you mean nodes?", "cell_centres, nodes"}},
    {"WrongCorrection",
     "[material]",
     "[quadrature]\nvolume_correction = \"lin\"\n[material]",
     18,
     {"quadrature.volume_correction", "none, linear"}},
    {"WrongSide", "\"x-\"", "\"z-\"", 13, {"lattice.layer[0].side", "x-, x+, y-, y+"}},
    {"WrongShape", "add = \"box\"", "add = \"bok\"", 8, {"did you mean box?", "disk"}},
    {"ShapeOfAnotherDimension",
     "add = \"box\"",
     "add = \"sphere\"",
     8,
     {"no sphere in dimension 2"}},
    {"WrongField",
     "name = \"tip\"",
     "name = \"tip\"\nfield = \"damages\"",
     27,
     {"did you mean damage?"}},
    {"AreaOfAPlate", "thickness = 0.1", "area = 0.1", 6, {"lattice.area", "dimension 1"}},
    // names of sets
    {"SetTwice",
     "name = \"right\"",
     "name = \"left\"",
     15,
     {"set[0].name = \"left\"", "taken by lattice.layer[0].name"}},
    {"UnknownSet",
     "set = \"left\"",
     "set = \"lefd\"",
     20,
     {"support[0].set = \"lefd\"", "did you mean left?", "there: left, right"}},
    {"UnknownSetOfAProbe",
     "name = \"tip\"\nset = \"right\"",
     "name = \"tip\"\nset = \"top\"",
     27,
     {"probe[0].set = \"top\""}},
    {"ProbeTwice",
     "name = \"tip\"\nset = \"right\"",
     "name = \"tip\"\nset = \"right\"\n[[probe]]\nname = \"tip\"\nset = \"left\"",
     29,
     {"probe[1].name = \"tip\""}},
    {"EmptyName", "name = \"right\"", "name = \"\"", 15, {"is empty"}},
    {"NameWithBlank", "name = \"tip\"", "name = \"the tip\"", 26, {"letters, digits, _ and -"}},
    {"NameWithComma", "name = \"left\"", "name = \"left,right\"", 12, {"letters, digits, _ and -"}},
    // expressions
    {"UnknownVariable",
     "1e-3*load",
     "1e-3*laod",
     21,
     {"support[0].displacement[1] = \"1e-3*laod\"", "laod"}},
    {"VariableOfAnotherDimension", "x > 0.9", "z > 0.9", 16, {"set[0].where = \"z > 0.9\"", "z"}},
    {"LoadInASet", "x > 0.9", "load > 0.9", 16, {"load"}},
    {"BrokenExpression", "1e6*load", "1e6*", 24, {"load[0].body_force[0] = \"1e6*\""}},
    {"PlaceInATotalForce",
     "body_force = [\"1e6*load\", 0]",
     "total_force = [\"1e6*x\", 0]",
     24,
     {"load[0].total_force[0] = \"1e6*x\"", "x"}},
    {"FreeForce", "\"1e6*load\"", "\"free\"", 24, {"write 0 for no force"}},
    {"EverythingFree", "[0, \"1e-3*load\"]", "[\"free\", \"free\"]", 21, {"has no effect"}},
};

INSTANTIATE_TEST_SUITE_P(BadInput, CaseRefusal, testing::ValuesIn(bad_inputs),
                         [](const auto& bad) { return bad.param.name; });

TEST_F(CaseReader, RefusesKeysOfAnotherDimension) {
  EXPECT_NE(
      refusal(with(bar, "area", "thickness")).find("lattice.thickness = 1e-6: is for dimension 2"),
      std::string::npos);
  EXPECT_NE(refusal(with(bar, "[material]", "[material]\nplane = \"stress\""))
                .find("study.toml:13:1: material.plane = \"stress\": is for dimension 2 only"),
            std::string::npos);
}

TEST_F(CaseReader, TakesWholeNumbersThatAreWrittenAsFloats) {
  const Case of = read(with(plate, "[[probe]]", "[loading]\nsteps = 20.0\n[[probe]]"));
  EXPECT_EQ(of.loading.steps, 20);
}

TEST_F(CaseReader, TakesATableWhoseParameterIsNamedAnywhere) {
  const std::string text = with(plate, "[[probe]]", "[loading]\ntable2 = [0, 1]\n[[probe]]");
  EXPECT_NE(refusal(text), "");
  EXPECT_EQ(refusal(with(text, "1e6*load", "1e6*load2")), "");
}

TEST_F(CaseReader, RefusesAnEmptyArrayOfTables) {
  EXPECT_EQ(refusal(with(bar, "dimension = 1", "dimension = 1\nload = []")),
            "study.toml:2:1: load = []: is empty; leave it out");
}

TEST_F(CaseReader, RefusesShapesWithoutInside) {
  EXPECT_NE(refusal(with(beam, "[0, 0.1]]", "[0.2, 0]]")).find("study.toml:21:1: lattice.shape[3]"),
            std::string::npos);
  EXPECT_NE(refusal(with(beam, "radius = 0.1\n", "radius = 0.1\naxis = [0, 0, 0]\n"))
                .find("study.toml:15:1: lattice.shape[1].axis"),
            std::string::npos);
}

TEST_F(CaseReader, RefusesAMissingPointFile) {
  EXPECT_EQ(refusal(cloud).find("study.toml:3:1: points.file = \"cloud.csv\": no such file"), 0u);
}

TEST_F(CaseReader, RefusesAMissingFileAndNamesASimilarOne) {
  write(plate, "tension.toml");
  EXPECT_EQ(refusal_of_file(folder_ / "tenson.toml"),
            "tenson.toml: no such case file; did you mean tension.toml?");
  EXPECT_EQ(refusal_of_file(folder_ / "tension"),
            "tension: no such case file; did you mean tension.toml?");
  EXPECT_EQ(refusal_of_file(folder_ / "entirely_different_name.toml")
                .find("entirely_different_name.toml: no such case file"),
            0u);
}

TEST_F(CaseReader, RefusesAFolder) {
  write(plate, "tension.toml");
  const std::string message = refusal_of_file(folder_);
  EXPECT_NE(message.find("is a folder, not a case file; it holds tension.toml"), std::string::npos)
      << message;
}

TEST_F(CaseReader, RefusesWhatNeverEnds) {
  EXPECT_EQ(refusal_of_file("/dev/zero"), "/dev/zero: is not a regular file");
}

TEST_F(CaseReader, RefusesNestingThatWouldOverflowTheStack) {
  const auto repeated = [](const std::string& part) {
    std::string text;
    for (int k = 0; k < 100'000; ++k) text += part;
    return text;
  };
  const std::string reason = ": a key of more than 16 parts";
  EXPECT_EQ(refusal("b = 1\na" + repeated(".a") + " = 1").find("study.toml:2:1" + reason), 0u);
  EXPECT_EQ(refusal("[a" + repeated(" . 'x=y'") + "]").find("study.toml:1:1" + reason), 0u);
  EXPECT_EQ(refusal("b = '''\n'''\na = { a" + repeated(".\"\\\"a\"") + " = 1 }")
                .find("study.toml:3:1" + reason),
            0u);
  EXPECT_NE(refusal("a = " + repeated("[")).find("not valid TOML"), std::string::npos);
  EXPECT_NE(refusal("a = " + repeated("{ a = ")).find("not valid TOML"), std::string::npos);
  EXPECT_NE(refusal(plate, {{"a" + repeated(".a"), "1"}}).find(reason), std::string::npos);
  EXPECT_NE(refusal(plate, {{"a" + repeated("[0]"), "1"}}).find(reason), std::string::npos);
}

TEST_F(CaseReader, TakesDotsInTextForWhatTheyAre) {
  std::string dots;
  for (int k = 0; k < 50; ++k) dots += "a.b.";
  const std::string title = "\"" + dots + "\"";
  const Case dotted = read("# " + dots + "\n" + with(plate, "\"Plate\"", title + "  # " + dots));
  EXPECT_EQ(dotted.title, dots);
}

TEST_F(CaseReader, RefusesAnEmptyFile) {
  EXPECT_EQ(refusal("").find("study.toml:1:1: dimension: this key is missing"), 0u);
}

// ---- Overrides

TEST_F(CaseOverride, ReplacesAndAddsKeys) {
  const Case changed = read(plate, {{"lattice.spacing", "0.05"},
                                    {"loading.steps", "50"},
                                    {"solver.linear", "\"cholesky\""},
                                    {"quadrature.surface_correction", "energy"},
                                    {"support[0].displacement", "[1, \"free\"]"},
                                    {"load[0].body_force[1]", "2e6*load"},
                                    {"output.directory", "2024"},
                                    {"probe[1]", "{ name = \"all\", set = \"left\" }"}});
  EXPECT_EQ(std::get<Lattice>(changed.body).spacing, 0.05);
  EXPECT_EQ(changed.loading.steps, 50);
  EXPECT_EQ(changed.solver.linear, LinearMethod::cholesky);
  EXPECT_EQ(changed.surface_correction, SurfaceCorrection::energy);
  EXPECT_EQ(changed.supports[0].displacement[0], "1");
  EXPECT_FALSE(changed.supports[0].displacement[1]);
  EXPECT_EQ(changed.loads[0].value[1], "2e6*load");
  EXPECT_EQ(changed.output.directory, "2024");
  ASSERT_EQ(changed.probes.size(), 2u);
  EXPECT_EQ(changed.probes[1].set, "left");
}

TEST_F(CaseOverride, TheLastOfAKeyHolds) {
  EXPECT_EQ(read(plate, {{"loading.steps", "5"}, {"loading.steps", "6"}}).loading.steps, 6);
}

TEST_F(CaseOverride, IsCheckedLikeTheFile) {
  EXPECT_EQ(
      refusal(plate, {{"loading.stepz", "50"}}),
      "--set loading.stepz=50: loading.stepz = 50: unknown key; did you mean steps?  (allowed: "
      "steps, table, table2, table3, table4, adaptive, smallest_step, largest_step, "
      "max_broken_bonds, stop_below, event_tolerance, teeth)");
  EXPECT_EQ(refusal(plate, {{"lattice.spacing", "-1"}}),
            "--set lattice.spacing=-1: lattice.spacing = -1: must be a positive number [m]");
  EXPECT_EQ(refusal(plate, {{"lattice.spacing", "small"}})
                .find("--set lattice.spacing=small: lattice.spacing = small: must be a positive"),
            0u);
  EXPECT_EQ(refusal(plate, {{"lading.steps", "50"}}).find("--set lading.steps=50: lading: unknown"),
            0u);
}

TEST_F(CaseOverride, RefusesKeysThatCanNotBeFollowed) {
  for (const std::string key : {"", ".", "a.", "loading..steps", "support[", "support[x].set",
                                "support[-1].set", "[0]", "support[99999999999999999999].set"}) {
    EXPECT_NE(refusal(plate, {{key, "1"}}).find("dotted keys such as"), std::string::npos) << key;
  }
  EXPECT_NE(refusal(plate, {{"support.set", "1"}}).find("name one of it: support[0] to support[0]"),
            std::string::npos);
  EXPECT_NE(refusal(plate, {{"support[2].set", "1"}}).find("support has 1 elements"),
            std::string::npos);
  EXPECT_NE(refusal(plate, {{"dimension.x", "1"}}).find("dimension is a whole number"),
            std::string::npos);
  EXPECT_NE(refusal(plate, {{"material[0].model", "bond"}}).find("not an array but a table"),
            std::string::npos);
}

// ---- As resolved

TEST_F(CaseText, IsAFixedPoint) {
  write("x, y, volume\n", "cloud.csv");
  const std::string odd_strings =
      with(plate, "\"Plate\"", R"("Plate \"é\" \\ \u0007")") + "[output]\ndirectory = 'a b\\c'\n";
  for (const std::string& text : {bar, plate, beam, cloud, odd_strings}) {
    const Case first = read(text);
    const Case second = read(first.as_resolved);
    EXPECT_EQ(first.as_resolved, second.as_resolved);
    EXPECT_EQ(first.title, second.title);
    EXPECT_EQ(first.output.directory, second.output.directory);
    EXPECT_EQ(first.supports[0].displacement, second.supports[0].displacement);
    EXPECT_EQ(first.loading.largest_step, second.loading.largest_step);
  }
}

TEST_F(CaseText, HoldsDefaultsAndOverrides) {
  const std::string text = read(plate, {{"loading.steps", "8"}}).as_resolved;
  for (const std::string line :
       {"origin = \"cell_centres\"", "volume_correction = \"none\"", "plane = \"stress\"",
        "steps = 8", "largest_step = 0.125", "linear = \"auto\"", "relative_tolerance = 1e-10",
        "every = 1", "field = \"displacement\"", "horizon_ratio = 3.015", "seed = 1"}) {
    EXPECT_NE(text.find("\n" + line + "\n"), std::string::npos) << line << "\nis not in\n" << text;
  }
}

// ---- Locations

TEST_F(CaseLocations, AreThoseOfKeysTablesAndElements) {
  const Case read_plate = read(plate, {{"loading.steps", "8"}});
  const auto line = [&](const std::string& key) { return read_plate.locations.at(key).line; };
  EXPECT_EQ(line("title"), 1);
  EXPECT_EQ(line("lattice"), 3);
  EXPECT_EQ(line("lattice.shape[0].max"), 10);
  EXPECT_EQ(line("support[0]"), 19);
  EXPECT_EQ(line("support[0].displacement"), 21);
  EXPECT_EQ(read_plate.locations.at("support[0].displacement").column, 1);
  EXPECT_EQ(read_plate.locations.at("support[0].displacement[1]").column, 20);
  EXPECT_EQ(read_plate.locations.at("loading.steps").override_text, "loading.steps=8");
}

TEST_F(CaseLocations, FallBackToTheLongestKnownPart) {
  const Case read_plate = read(plate, {{"loading.steps", "8"}});
  const std::string file = read_plate.file;
  EXPECT_EQ(located(read_plate, "lattice.spacing", "why"), file + ":4:1: why");
  EXPECT_EQ(located(read_plate, "support[0].displacement[7]", "why"), file + ":21:1: why");
  EXPECT_EQ(located(read_plate, "material.damage.law", "why"), file + ":17:1: why");
  EXPECT_EQ(located(read_plate, "support[3].set", "why"), file + ":19:1: why");
  EXPECT_EQ(located(read_plate, "output.directory", "why"), file + ": why");
  EXPECT_EQ(located(read_plate, "", "why"), file + ": why");
  EXPECT_EQ(located(read_plate, "loading.steps", "why"), "--set loading.steps=8: why");
}

TEST_F(CaseLocations, GoInFrontOfErrorsOfLowerFloorsOnce) {
  const Case read_plate = read(plate);
  const InputError error =
      located(read_plate, InputError("set[0].where", "x > 9", "selects nothing"));
  EXPECT_EQ(error.what(), read_plate.file + ":16:1: set[0].where = x > 9: selects nothing");
  EXPECT_EQ(error.key(), "set[0].where");
  EXPECT_STREQ(located(read_plate, error).what(), error.what());
}

TEST_F(CaseLocations, NameTheKeyOfWhatALowerFloorWasGiven) {
  const std::string total = with(plate, "body_force = [\"1e6*load\", 0]", "total_force = [1, 0]");
  const std::string hole = with(plate, "[[lattice.layer]]",
                                "[[lattice.shape]]\nsubtract = \"disk\"\ncentre = [0, 0]\nradius = "
                                "0.01\n[[lattice.layer]]");
  const auto key = [&](const std::string& text, const std::string& member) {
    return located(read(text), InputError(member, "", "why")).key();
  };
  EXPECT_EQ(key(plate, "supports[0].displacement[1]"), "support[0].displacement[1]");
  EXPECT_EQ(key(plate, "supports[0].set"), "support[0].set");
  EXPECT_EQ(key(plate, "loads[0].value[1]"), "load[0].body_force[1]");
  EXPECT_EQ(key(total, "loads[0].value[1]"), "load[0].total_force[1]");
  EXPECT_EQ(key(hole, "shapes[0].action"), "lattice.shape[0].add");
  EXPECT_EQ(key(hole, "shapes[1].action"), "lattice.shape[1].subtract");
  EXPECT_EQ(key(hole, "shapes[1].radius"), "lattice.shape[1].radius");
  EXPECT_EQ(key(plate, "shapes"), "lattice.shape");
  EXPECT_EQ(key(plate, "layers[0].where"), "lattice.layer[0].where");
  EXPECT_EQ(key(plate, "spacing"), "lattice.spacing");
  EXPECT_EQ(key(plate, "cross_section"), "lattice.thickness");
  EXPECT_EQ(key(bar, "cross_section"), "lattice.area");
  EXPECT_EQ(key(plate, "directory"), "output.directory");
  write("x, y, volume\n", "cloud.csv");
  EXPECT_EQ(key(cloud, "cross_section"), "points.thickness");
  EXPECT_EQ(key(cloud, "file"), "points.file");
  EXPECT_EQ(key(plate, "material.c2"), "material.c2");  // a key already
}

// ---- Documentation and shipped cases

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  EXPECT_TRUE(in.is_open()) << file;
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(CaseDocumentation, ExampleIsACase) {
  const std::string page = text_of(fs::path(PERISTAT_SOURCE_DIR) / "docs/case-file.md");
  const std::string fence = "```toml\n";
  const auto begin = page.find(fence);
  ASSERT_NE(begin, std::string::npos);
  const auto end = page.find("```", begin + fence.size());
  EXPECT_EQ(refusal(page.substr(begin + fence.size(), end - begin - fence.size())), "");
}

TEST_F(ShippedCases, AreRead) {
  const fs::path cases = fs::path(PERISTAT_SOURCE_DIR) / "cases";
  std::vector<std::string> directories;
  for (const auto& entry : fs::recursive_directory_iterator(cases)) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_EQ(refusal_of_file(entry.path()), "");
    const std::string resolved = read_case(entry.path()).as_resolved;
    EXPECT_EQ(read_case(entry.path(), resolved, {}).as_resolved, resolved) << entry.path();
    directories.push_back(read_case(entry.path()).output.directory.string());
  }
  ASSERT_GE(directories.size(), 4u);
  std::sort(directories.begin(), directories.end());
  EXPECT_EQ(std::adjacent_find(directories.begin(), directories.end()), directories.end());
  EXPECT_EQ(read_case(cases / "plate_with_hole/elastic.toml").output.directory,
            fs::path("results/plate_with_hole_elastic"));
}

}  // namespace
}  // namespace peristat
