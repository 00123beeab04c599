#include "cases/runner/results/results.hpp"

#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>
#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "src/core/input_error.hpp"
#include "src/core/machine_error.hpp"

namespace peristat {
namespace {

namespace fs = std::filesystem;

std::string read_text(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

std::vector<std::string> lines(const fs::path& file) {
  std::istringstream text(read_text(file));
  std::vector<std::string> all;
  for (std::string line; std::getline(text, line);) all.push_back(line);
  return all;
}

/// Reads an HDF5 file with the library's own calls, as any reader would.
class Reader {
 public:
  explicit Reader(const fs::path& file)
      : file_(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {}
  ~Reader() {
    if (file_ >= 0) H5Fclose(file_);
  }
  [[nodiscard]] bool is_open() const { return file_ >= 0; }

  [[nodiscard]] bool has(const std::string& path) const {
    const hid_t object = H5Oopen(file_, path.c_str(), H5P_DEFAULT);
    if (object >= 0) H5Oclose(object);
    return object >= 0;
  }

  [[nodiscard]] std::vector<hsize_t> shape(const std::string& path) const {
    const hid_t dataset = H5Dopen2(file_, path.c_str(), H5P_DEFAULT);
    if (dataset < 0) return {999};
    const hid_t space = H5Dget_space(dataset);
    std::vector<hsize_t> extent(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, extent.data(), nullptr);
    H5Sclose(space);
    H5Dclose(dataset);
    return extent;
  }

  [[nodiscard]] std::vector<double> numbers(const std::string& path) const {
    std::size_t size = 1;
    for (const hsize_t extent : shape(path)) size *= extent;
    std::vector<double> values(size, -999.0);
    const hid_t dataset = H5Dopen2(file_, path.c_str(), H5P_DEFAULT);
    H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(dataset);
    return values;
  }

  [[nodiscard]] std::vector<std::string> texts(const std::string& path) const {
    const hid_t dataset = H5Dopen2(file_, path.c_str(), H5P_DEFAULT);
    const hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
    std::vector<char*> pointers(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data());
    const std::vector<std::string> all(pointers.begin(), pointers.end());
    H5Dvlen_reclaim(type, space, H5P_DEFAULT, pointers.data());
    H5Tclose(type);
    H5Sclose(space);
    H5Dclose(dataset);
    return all;
  }

  [[nodiscard]] std::vector<std::string> text_attribute(const std::string& path,
                                                        const std::string& name) const {
    const hid_t object = H5Oopen(file_, path.c_str(), H5P_DEFAULT);
    const hid_t attribute = H5Aopen(object, name.c_str(), H5P_DEFAULT);
    if (attribute < 0) return {};
    const hid_t space = H5Aget_space(attribute), type = H5Aget_type(attribute);
    std::vector<char*> pointers(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Aread(attribute, type, pointers.data());
    const std::vector<std::string> all(pointers.begin(), pointers.end());
    H5Dvlen_reclaim(type, space, H5P_DEFAULT, pointers.data());
    H5Tclose(type);
    H5Sclose(space);
    H5Aclose(attribute);
    H5Oclose(object);
    return all;
  }

  [[nodiscard]] double number_attribute(const std::string& path, const std::string& name) const {
    const hid_t object = H5Oopen(file_, path.c_str(), H5P_DEFAULT);
    const hid_t attribute = H5Aopen(object, name.c_str(), H5P_DEFAULT);
    double value = -999.0;
    H5Aread(attribute, H5T_NATIVE_DOUBLE, &value);
    H5Aclose(attribute);
    H5Oclose(object);
    return value;
  }

  /// Paths of all datasets, also of those behind links to other files.
  [[nodiscard]] std::vector<std::string> datasets(const std::string& group = "/") const {
    std::vector<std::string> found;
    for (const std::string& name : members(group)) {
      const std::string path = (group == "/" ? "" : group) + "/" + name;
      const hid_t object = H5Oopen(file_, path.c_str(), H5P_DEFAULT);
      const bool is_group = H5Iget_type(object) == H5I_GROUP;
      H5Oclose(object);
      if (!is_group) {
        found.push_back(path);
        continue;
      }
      for (const std::string& below : datasets(path)) found.push_back(below);
    }
    return found;
  }

  [[nodiscard]] std::vector<std::string> members(const std::string& group) const {
    std::vector<std::string> names;
    const hid_t object = H5Gopen2(file_, group.c_str(), H5P_DEFAULT);
    H5G_info_t info{};
    H5Gget_info(object, &info);
    for (hsize_t i = 0; i < info.nlinks; ++i) {
      char name[256];
      H5Lget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name,
                         H5P_DEFAULT);
      names.emplace_back(name);
    }
    H5Gclose(object);
    return names;
  }

 private:
  hid_t file_;
};

/// A folder of its own for every test.
class ResultsTest : public testing::Test {
 protected:
  ResultsTest() {
    std::string name = (fs::temp_directory_path() / "peristat_results_XXXXXX").string();
    base = mkdtemp(name.data());
    directory = base / "results";
  }
  ~ResultsTest() override { fs::remove_all(base); }

  fs::path base, directory;
};

constexpr Index count = 6;

Points example_points(int dimension) {
  Points points;
  points.dimension = dimension;
  points.spacing = 0.5;
  for (Index i = 0; i < count; ++i) {
    points.volume.push_back(1.0 + i);
    for (int c = 0; c < dimension; ++c) points.reference.push_back(10.0 * i + c);
  }
  points.sets = {{"left, \"top\"", {0, 2}}, {"right", {5}}};
  return points;
}

const std::vector<std::string> support_sets{"right", "left, \"top\""};
const std::vector<ProbeColumns> probes{{"tip", 2, "m"}, {"crack", 1, "1"}};
const CaseText case_text{"a = 1 # \xc3\xa4\n", "a = 2\n", "Example", {{"peristat", "1.2.3"}}};

/// Fields whose every value depends on step, point and component.
struct ExampleFields {
  ExampleFields(int step, int dimension) {
    for (int i = 0; i < count * dimension; ++i) {
      displacement.push_back(step + 0.01 * i);
      force.push_back(-step - 0.03 * i);
    }
    for (int i = 0; i < count; ++i) {
      damage.push_back(0.1 * i / step);
      energy_density.push_back(7.0 * i + step);
    }
  }
  [[nodiscard]] StepFields views() const {
    return {{{"displacement", displacement},
             {"force", force},
             {"damage", damage},
             {"energy_density", energy_density}}};
  }
  std::vector<double> displacement, force, damage, energy_density;
};

StepRecord example_step(int step) {
  StepRecord record;
  record.step = step;
  record.stage = 1.5;
  record.control = 1.25e-5;
  record.negative_pivots = 2;
  record.is_on_response = false;
  record.released_energy = 0.375;
  record.strut_energy = 0.03125;
  record.stability = Stability::unstable;
  record.load_factor = 0.1 * step;
  record.mode = "newton";
  record.newton_iterations = 4;
  record.relaxation_iterations = 100;
  record.stored_energy = step / 3.0;
  record.dissipated_energy = 0.25;
  record.drained_energy = 0.125;
  record.external_work = 5.0;
  record.balance_error = 1e-17;
  record.broken_bonds = 3;
  record.max_damage = 0.5;
  record.max_stretch = 0.01;
  record.numerical_work = 0.0625;
  record.pin_force = 0.75;
  record.settled = true;
  record.reactions = {{"right", {1.0 * step, 2.0, 0.0}},
                      {"left, \"top\"", {-1.0 * step, -2.0, 0.0}}};
  record.probes = {{"tip", {0.5, -0.5 * step}}, {"crack", {9.0}}};
  return record;
}

void add_step(Results& results, int step, int dimension = 2) {
  results.add(IterationRecord{step, 0, 100.0, 1.0, -1.0, 1.0, 0, 0});
  results.add(IterationRecord{step, 1, 1e-9, 1e-11, -2.0, 0.5, 17, 3, 0.25, 12, 4, 1, 1e-6});
  results.add(DecisionRecord{step, 1.5, 0.1 * step, 0.1, "converged", Decision::accept_and_grow,
                             0.2, "quick, \"easy\""});
  const ExampleFields fields(step, dimension);
  results.add(example_step(step), fields.views());
}

Results open_results(const fs::path& directory, int dimension = 2) {
  return Results(directory, example_points(dimension), case_text, support_sets, probes);
}

void expect_step(const Reader& file, int step, int dimension) {
  char name[32];
  std::snprintf(name, sizeof name, "/steps/%06d", step);
  const std::string group = name;
  const ExampleFields fields(step, dimension);
  EXPECT_EQ(file.numbers(group + "/displacement"), fields.displacement) << group;
  EXPECT_EQ(file.numbers(group + "/force"), fields.force) << group;
  EXPECT_EQ(file.numbers(group + "/damage"), fields.damage) << group;
  EXPECT_EQ(file.numbers(group + "/energy_density"), fields.energy_density) << group;
  EXPECT_EQ(file.number_attribute(group, "step"), step);
  EXPECT_EQ(file.number_attribute(group, "load_factor"), 0.1 * step);
  EXPECT_EQ(file.text_attribute(group, "mode"), std::vector<std::string>{"newton"});
}

/// Everything that results.h5 holds after steps 1 and 2, in links or gathered.
void expect_contents(const Reader& file, int dimension) {
  ASSERT_TRUE(file.is_open());
  using Shape = std::vector<hsize_t>;
  const auto d = static_cast<hsize_t>(dimension);
  const Points points = example_points(dimension);
  EXPECT_EQ(file.shape("/points/reference"), (Shape{count, d}));
  EXPECT_EQ(file.numbers("/points/reference"), points.reference);
  EXPECT_EQ(file.numbers("/points/volume"), points.volume);
  EXPECT_EQ(file.shape("/points/set_ids"), (Shape{count, 2}));
  EXPECT_EQ(file.numbers("/points/set_ids"),
            (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1}));
  EXPECT_EQ(file.text_attribute("/points/set_ids", "sets"),
            (std::vector<std::string>{"left, \"top\"", "right"}));
  EXPECT_EQ(file.number_attribute("/points", "spacing"), 0.5);

  EXPECT_EQ(file.members("/steps"), (std::vector<std::string>{"000001", "000002"}));
  EXPECT_EQ(file.shape("/steps/000001/displacement"), (Shape{count, d}));
  EXPECT_EQ(file.shape("/steps/000001/force"), (Shape{count, d}));
  EXPECT_EQ(file.shape("/steps/000001/damage"), Shape{count});
  EXPECT_EQ(file.shape("/steps/000001/energy_density"), Shape{count});
  expect_step(file, 1, dimension);
  expect_step(file, 2, dimension);

  EXPECT_EQ(file.numbers("/history/step"), (std::vector<double>{1, 2}));
  EXPECT_EQ(file.numbers("/history/stored_energy"), (std::vector<double>{1 / 3.0, 2 / 3.0}));
  EXPECT_EQ(file.numbers("/history/reaction_x:left, \"top\""), (std::vector<double>{-1, -2}));
  EXPECT_EQ(file.numbers("/history/tip_y"), (std::vector<double>{-0.5, -1}));
  EXPECT_EQ(file.texts("/history/mode"), (std::vector<std::string>{"newton", "newton"}));
  EXPECT_EQ(file.numbers("/iterations/iteration"), (std::vector<double>{0, 1, 0, 1}));
  EXPECT_EQ(file.numbers("/iterations/changed_bonds"), (std::vector<double>{0, 3, 0, 3}));
  EXPECT_EQ(file.texts("/decisions/reason"),
            (std::vector<std::string>{"quick, \"easy\"", "quick, \"easy\""}));

  EXPECT_EQ(file.texts("/case/as_read"), std::vector<std::string>{case_text.as_read});
  EXPECT_EQ(file.texts("/case/as_resolved"), std::vector<std::string>{case_text.as_resolved});
  EXPECT_EQ(file.text_attribute("/", "title"), std::vector<std::string>{"Example"});
  EXPECT_EQ(file.text_attribute("/", "peristat_version"), std::vector<std::string>{"1.2.3"});
  EXPECT_EQ(file.text_attribute("/", "hdf5_version").size(), 1u);

  const std::vector<std::string> datasets = file.datasets();
  EXPECT_GT(datasets.size(), 40u);
  for (const std::string& path : datasets) {
    for (const char* name : {"unit", "description"}) {
      const auto text = file.text_attribute(path, name);
      ASSERT_EQ(text.size(), 1u) << path << " " << name;
      EXPECT_NE(text.front(), "") << path << " " << name;
    }
  }
  EXPECT_EQ(file.text_attribute("/history/tip_x", "unit"), std::vector<std::string>{"m"});
  EXPECT_EQ(file.text_attribute("/history/reaction_x:right", "unit"),
            std::vector<std::string>{"N"});
}

TEST_F(ResultsTest, FileIsReadableDuringTheRunAndAfterDestructionWithoutClose) {
  {
    Results results = open_results(directory);
    EXPECT_TRUE(Reader(directory / "results.h5").has("/points/reference"));
    add_step(results, 1);
    add_step(results, 2);
    expect_contents(Reader(directory / "results.h5"), 2);
  }
  expect_contents(Reader(directory / "results.h5"), 2);
  EXPECT_TRUE(fs::exists(directory / "results.xdmf"));
  EXPECT_FALSE(fs::exists(directory / "summary.json"));
}

TEST_F(ResultsTest, ClosedFileHoldsEverythingByItself) {
  for (const int dimension : {1, 2, 3}) {
    Results results = open_results(directory, dimension);
    add_step(results, 1, dimension);
    add_step(results, 2, dimension);
    results.close({});
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory)) {
      names.insert(entry.path().filename().string());
    }
    EXPECT_EQ(names, (std::set<std::string>{"broken_bonds.csv", "convergence.csv", "decisions.csv",
                                            "history.csv", "iterations.csv",
                                            "load_displacement.csv", "peristat.json", "results.h5",
                                            "results.vtkhdf", "results.xdmf", "summary.json"}));
    const fs::path alone = base / "alone.h5";
    fs::rename(directory / "results.h5", alone);
    expect_contents(Reader(alone), dimension);
    EXPECT_THROW(add_step(results, 3, dimension), std::logic_error);
    fs::rename(alone, directory / "results.h5");
  }
}

TEST_F(ResultsTest, LinksResolveFromAnotherWorkingDirectoryAndAfterAMove) {
  {
    Results results = open_results(directory);
    add_step(results, 1);
  }
  fs::rename(directory, base / "moved");
  const fs::path before = fs::current_path();
  fs::current_path("/");
  expect_step(Reader(base / "moved" / "results.h5"), 1, 2);
  fs::current_path(before);
}

TEST_F(ResultsTest, XdmfRefersToDatasetsOfItsDimensions) {
  for (const int dimension : {1, 2, 3}) {
    for (const bool closed : {false, true}) {
      {
        Results results = open_results(directory, dimension);
        add_step(results, 1, dimension);
        add_step(results, 2, dimension);
        if (closed) results.close({});
      }
      const std::string xdmf = read_text(directory / "results.xdmf");
      const Reader file(directory / "results.h5");
      const std::regex item("Dimensions=\"([0-9 ]+)\">results.h5:([^<]+)<");
      int items = 0;
      for (std::sregex_iterator i(xdmf.begin(), xdmf.end(), item), end; i != end; ++i, ++items) {
        std::istringstream text((*i)[1]);
        std::vector<hsize_t> dimensions;
        for (hsize_t extent; text >> extent;) dimensions.push_back(extent);
        const std::string dataset = std::regex_replace((*i)[2].str(), std::regex("&quot;"), "\"");
        EXPECT_EQ(file.shape(dataset), dimensions) << dataset;
      }
      // topology, geometry, four fields, volume and the sets
      const auto sets = example_points(dimension).sets;
      EXPECT_EQ(items, 2 * int(6 + 1 + sets.size()));
      for (const auto& [name, members] : sets) {
        const std::string dataset = "/points/sets/" + name;
        const std::string told = std::regex_replace(name, std::regex("\""), "&quot;");
        EXPECT_NE(xdmf.find("Name=\"set_" + told + "\""), std::string::npos);
        const std::vector<double> flags = file.numbers(dataset);
        EXPECT_EQ(std::accumulate(flags.begin(), flags.end(), 0.0), double(members.size()));
        for (const Index point : members) EXPECT_EQ(flags.at(std::size_t(point)), 1.0);
      }
      EXPECT_NE(xdmf.find("<Attribute Name=\"volume\""), std::string::npos);
      const std::regex load(
          "\"load_factor\" AttributeType=\"Scalar\" Center=\"Grid\">[^>]+>([^<]+)<");
      std::smatch first;
      ASSERT_TRUE(std::regex_search(xdmf, first, load));
      EXPECT_EQ(std::stod(first[1]), file.number_attribute("/steps/000001", "load_factor"));
      EXPECT_EQ(xdmf.find("peristat"), std::string::npos);
      if (dimension == 3) continue;
      const std::vector<double> stored = ExampleFields(2, dimension).displacement;
      const std::vector<double> shown = file.numbers("/xdmf/000002/displacement");
      ASSERT_EQ(shown.size(), 3u * count);
      for (int i = 0; i < 3 * count; ++i) {
        const int c = i % 3;
        EXPECT_EQ(shown[i], c < dimension ? stored[i / 3 * dimension + c] : 0.0);
      }
    }
  }
}

TEST_F(ResultsTest, TablesHaveTheColumnsOfTheContract) {
  Results results = open_results(directory);
  add_step(results, 1);
  EXPECT_EQ(
      lines(directory / "history.csv"),
      (std::vector<std::string>{
          "step,load_factor,mode,newton_iterations,relaxation_iterations,stored_energy,"
          "dissipated_energy,drained_energy,external_work,balance_error,broken_bonds,"
          "max_damage,max_stretch,reaction_x:right,reaction_y:right,reaction_z:right,"
          "\"reaction_x:left, \"\"top\"\"\",\"reaction_y:left, \"\"top\"\"\","
          "\"reaction_z:left, \"\"top\"\"\",tip_x,tip_y,crack,numerical_work,pin_force,settled,"
          "stage,control,negative_pivots,on_response,released_energy,stability,strut_energy",
          "1,0.1,newton,4,100,0.3333333333333333,0.25,0.125,5,1e-17,3,0.5,0.01,1,2,0,-1,-2,0,0.5,"
          "-0.5,9,0.0625,0.75,1,1.5,1.25e-05,2,0,0.375,-1,0.03125"}));
  EXPECT_EQ(lines(directory / "iterations.csv"),
            (std::vector<std::string>{
                "step,iteration,residual,relative_residual,energy,step_length,"
                "linear_iterations,changed_bonds,projection,negative_pivots,"
                "rejected_trials,degenerate_trials,linear_tolerance",
                "1,0,100,1,-1,1,0,0,0,0,0,0,0", "1,1,1e-09,1e-11,-2,0.5,17,3,0.25,12,4,1,1e-06"}));
  EXPECT_EQ(lines(directory / "decisions.csv"),
            (std::vector<std::string>{
                "step,load_factor,increment,outcome,action,next_increment,reason,stage",
                "1,0.1,0.1,converged,accept and grow,0.2,\"quick, \"\"easy\"\"\",1.5"}));
}

TEST_F(ResultsTest, TablesStayWholeOverManyPages) {
  Results results = open_results(directory);
  for (int i = 0; i < 2000; ++i) {
    results.add(IterationRecord{1, i, 1.0 / (i + 1), 0.5, -1.0, 1.0, 0, 0});
  }
  EXPECT_GT(fs::file_size(directory / "iterations.csv"), 10u * 4096);
  const std::vector<std::string> rows = lines(directory / "iterations.csv");
  ASSERT_EQ(rows.size(), 2001u);
  for (int i = 0; i < 2000; ++i) {
    int step = 0, iteration = 0;
    double residual = 0.0;
    ASSERT_EQ(
        std::sscanf(rows[i + 1].c_str(), "%d,%d,%lf,0.5,-1,1,0,0", &step, &iteration, &residual),
        3);
    EXPECT_EQ(iteration, i);
    EXPECT_EQ(residual, 1.0 / (i + 1));
  }
}

TEST_F(ResultsTest, StepWithoutFieldsEntersTheHistoryOnly) {
  Results results = open_results(directory);
  results.add(example_step(1));
  add_step(results, 2);
  const Reader file(directory / "results.h5");
  EXPECT_EQ(file.members("/steps"), std::vector<std::string>{"000002"});
  EXPECT_EQ(file.numbers("/history/step"), (std::vector<double>{1, 2}));
}

TEST_F(ResultsTest, DecisionsAfterTheLastStepArePublishedByClose) {
  Results results = open_results(directory);
  results.add(DecisionRecord{1, 0.5, 0.5, 0.5, "stalled", Decision::stop, 0.0, "too small"});
  results.close({});
  EXPECT_EQ(Reader(directory / "results.h5").texts("/decisions/action"),
            std::vector<std::string>{"stop"});
}

TEST_F(ResultsTest, SummaryTakesSumsFromAllStepsAndTheRestFromTheLast) {
  Results results = open_results(directory);
  add_step(results, 1);
  add_step(results, 2);
  Summary summary;
  summary.status = "not_converged";
  summary.reason = "line\n\"quoted\" \\";
  summary.points = 6;
  summary.free_dofs = 5'000'000'000;
  summary.count("bonds", 11);
  summary.count("triangles", 12);
  summary.count("tetrahedra", 13);
  summary.costs.factorisations = 14;
  summary.costs.linear_iterations = 15;
  summary.max_displacement = 0.1;
  summary.costs.seconds = {1, 2, 3, 4, 5, 6.5, 7};
  summary.threads = 2;
  results.close(summary);
  const std::string json =
      std::regex_replace(read_text(directory / "summary.json"),
                         std::regex("(\"peak_memory_bytes\": )[1-9][0-9]*"), "$1M");
  EXPECT_EQ(json, R"({
  "status": "not_converged",
  "reason": "line\n\"quoted\" \\",
  "points": 6,
  "free_dofs": 5000000000,
  "bonds": 11,
  "triangles": 12,
  "tetrahedra": 13,
  "steps": 2,
  "newton_iterations": 8,
  "relaxation_iterations": 200,
  "factorisations": 14,
  "linear_iterations": 15,
  "broken_bonds": 3,
  "max_damage": 0.5,
  "max_displacement": 0.1,
  "energy": {
    "stored": 0.6666666666666666,
    "dissipated": 0.25,
    "drained": 0.125,
    "external_work": 5,
    "numerical_work": 0.0625,
    "balance_error": 1e-17
  },
  "reactions": {
    "left, \"top\"": [-2, -2, 0],
    "right": [2, 2, 0]
  },
  "probes": {
    "crack": 9,
    "tip": [0.5, -1]
  },
  "seconds": {
    "total": 1,
    "neighbourhood": 2,
    "assembly": 3,
    "linear": 4,
    "relaxation": 5,
    "output": 6.5,
    "checkpoints": 7
  },
  "peak_memory_bytes": M,
  "threads": 2,
  "ranks": 1,
  "warnings": []
}
)");
}

TEST_F(ResultsTest, NumbersThatAreNotFiniteAreRefusedBeforeAnythingIsWritten) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Results results = open_results(directory);
  EXPECT_THROW(results.add(IterationRecord{1, 0, nan, 1.0, 1.0, 1.0, 0, 0}), std::logic_error);
  StepRecord record = example_step(1);
  record.reactions["right"][1] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(results.add(record), std::logic_error);
  ExampleFields fields(1, 2);
  fields.force[3] = nan;
  EXPECT_THROW(results.add(example_step(1), fields.views()), std::logic_error);
  fields.force.pop_back();
  EXPECT_THROW(results.add(example_step(1), fields.views()), std::logic_error);
  record = example_step(1);
  record.probes.erase("tip");
  EXPECT_THROW(results.add(record), std::logic_error);
  add_step(results, 1);
  EXPECT_THROW(results.add(example_step(1)), std::logic_error) << "the same step again";
  EXPECT_EQ(lines(directory / "history.csv").size(), 2u);
  EXPECT_EQ(lines(directory / "iterations.csv").size(), 3u);
  EXPECT_EQ(Reader(directory / "results.h5").numbers("/history/step"), std::vector<double>{1});
}

TEST_F(ResultsTest, ProbesWithTheNameOfAnotherColumnAreRefused) {
  const Points points = example_points(2);
  for (const std::vector<ProbeColumns>& clash : std::vector<std::vector<ProbeColumns>>{
           {{"step", 1, "m"}}, {{"tip", 2, "m"}, {"tip_x", 1, "m"}}}) {
    try {
      Results(directory, points, case_text, support_sets, clash);
      ADD_FAILURE() << "accepted";
    } catch (const InputError& error) {
      EXPECT_EQ(error.key(), "probe");
      EXPECT_EQ(error.value(), clash.back().name);
    }
    EXPECT_FALSE(fs::exists(directory));
  }
}

TEST_F(ResultsTest, AnEarlierRunIsReplacedAndOtherFilesAreKept) {
  {
    Results results = open_results(directory);
    add_step(results, 1);
    add_step(results, 2);
  }
  fs::create_directory(directory / "plots");
  std::ofstream(directory / "plots" / ".pictures") << "old.png\n";
  std::ofstream(directory / "plots" / "old.png") << "old";
  std::ofstream(directory / "plots" / "mine.png") << "mine";
  std::ofstream(directory / "plots" / "notes.txt") << "mine";
  std::ofstream(directory / "parts" / "notes.txt") << "mine";
  std::ofstream(directory / "notes.txt") << "mine";
  std::ofstream(directory / "summary.json") << "old";
  Results results = open_results(directory);
  EXPECT_FALSE(fs::exists(directory / "plots" / "old.png"));
  EXPECT_FALSE(fs::exists(directory / "summary.json"));
  EXPECT_FALSE(fs::exists(directory / "results.xdmf"));
  EXPECT_FALSE(fs::exists(directory / "parts" / "000001.h5"));
  for (const char* kept : {"notes.txt", "plots/notes.txt", "plots/mine.png", "parts/notes.txt"}) {
    EXPECT_EQ(read_text(directory / kept), "mine") << kept;
  }
  add_step(results, 1);
  EXPECT_EQ(Reader(directory / "results.h5").numbers("/history/step"), std::vector<double>{1});
  results.close({});
  EXPECT_EQ(read_text(directory / "parts" / "notes.txt"), "mine");
}

TEST_F(ResultsTest, AFolderThatCannotBeUsedIsRefusedByName) {
  std::ofstream(base / "file") << "mine";
  fs::create_directory(base / "home");
  std::ofstream(base / "home" / "letter.txt") << "mine";
  fs::create_directory(base / "home" / "plots");
  for (const fs::path& folder : {base / "file", base / "file" / "below", base / "home",
                                 fs::path("/proc/peristat"), fs::path("")}) {
    try {
      open_results(folder);
      ADD_FAILURE() << folder << " was accepted";
    } catch (const InputError& error) {
      EXPECT_EQ(error.key(), "directory");
      EXPECT_EQ(error.value(), folder.string());
      EXPECT_NE(error.allowed(), "");
    }
  }
  EXPECT_EQ(read_text(base / "file"), "mine");
  EXPECT_EQ(lines(base / "home" / "letter.txt"), std::vector<std::string>{"mine"});
}

TEST_F(ResultsTest, AnEarlierRunOfAnotherCaseIsReplacedOnDemandOnly) {
  CaseText first = case_text, second = case_text;
  first.file = "/cases/first \"quoted\".toml";
  second.file = "/cases/second.toml";
  const auto open = [&](const CaseText& text, bool overwrite) {
    return Results(directory, example_points(2), text, support_sets, probes, {}, overwrite);
  };
  {
    Results results = open(first, false);
    add_step(results, 1);
  }
  EXPECT_THROW(open(second, false), InputError);
  EXPECT_EQ(Reader(directory / "results.h5").numbers("/history/step"), std::vector<double>{1});
  { Results results = open(first, false); }
  { Results results = open(second, true); }
  EXPECT_THROW(open(first, false), InputError);
}

TEST_F(ResultsTest, AFolderHasOneWriter) {
  {
    Results results = open_results(directory);
    add_step(results, 1);
    try {
      open_results(directory);
      ADD_FAILURE() << "a second writer was accepted";
    } catch (const InputError& error) {
      EXPECT_NE(error.allowed().find(std::to_string(::getpid())), std::string::npos);
    }
    add_step(results, 2);
    results.close({});
  }
  expect_contents(Reader(directory / "results.h5"), 2);
  Results results = open_results(directory);
}

TEST_F(ResultsTest, HistoriesOfBondsAreWrittenWithTheStep) {
  Results results = open_results(directory);
  const ExampleFields fields(1, 2);
  StepFields views = fields.views();
  const BondHistories changed{{0, 3}, {2, 5}, {0.02, -1.0}, {}}, none;
  views.histories = changed;
  results.add(example_step(1), views);
  views.histories = none;
  results.add(example_step(2), views);
  const auto expect_histories = [&] {
    const Reader file(directory / "results.h5");
    EXPECT_EQ(file.numbers("/steps/000001/history/first_point"), (std::vector<double>{0, 3}));
    EXPECT_EQ(file.numbers("/steps/000001/history/second_point"), (std::vector<double>{2, 5}));
    EXPECT_EQ(file.numbers("/steps/000001/history/largest_stretch"),
              (std::vector<double>{0.02, -1.0}));
    EXPECT_EQ(file.shape("/steps/000002/history/largest_stretch"), std::vector<hsize_t>{0});
  };
  expect_histories();
  results.close({});
  expect_histories();
}

TEST_F(ResultsTest, BondsToImagesAreTold) {
  Points points = example_points(2);
  points.images.kinds = {{{-1.0, 1.0, 1.0}, {4.0, 0.0, 0.0}, {}},
                         {{1.0, 1.0, 1.0}, {0.0, -3.0, 0.0}, {0, -1, 0}}};
  Results results(directory, points, case_text, support_sets, probes);
  const ExampleFields fields(1, 2);
  StepFields views = fields.views();
  const BondHistories changed{{0, 3}, {0, 1}, {0.02, 0.01}, {2, 0}};
  views.histories = changed;
  results.add({{1, 0.1, 0, 0, 2}, {1, 0.1, 3, 1, 0}});
  results.add(example_step(1), views);
  results.close({});
  const Reader file(directory / "results.h5");
  EXPECT_EQ(file.shape("/points/images/mirror"), (std::vector<hsize_t>{2, 2}));
  EXPECT_EQ(file.numbers("/points/images/mirror"), (std::vector<double>{-1, 1, 1, 1}));
  EXPECT_EQ(file.numbers("/points/images/shift"), (std::vector<double>{4, 0, 0, -3}));
  EXPECT_EQ(file.numbers("/steps/000001/history/second_image"), (std::vector<double>{2, 0}));
  EXPECT_EQ(file.numbers("/broken_bonds/second_image"), (std::vector<double>{2, 0}));
  EXPECT_EQ(file.numbers("/cracks/000001/bonds"), (std::vector<double>{3, 1}));
  EXPECT_EQ(file.numbers("/cracks/000001/step"), (std::vector<double>{1}));
  EXPECT_EQ(read_text(directory / "broken_bonds.csv"),
            "step,load_factor,first_point,second_point,second_image\n1,0.1,0,0,2\n1,0.1,3,1,0\n");
}

TEST_F(ResultsTest, LinesAreTheBondsBrokenSoFar) {
  for (const bool closed : {false, true}) {
    {
      Results results = open_results(directory);
      add_step(results, 1);
      results.add({{2, 0.2, 0, 3, 0}, {2, 0.2, 1, 3, 0}});
      add_step(results, 2);
      results.add({{3, 0.3, 0, 5, 0}});
      add_step(results, 3);
      if (closed) results.close({});
    }
    const Reader file(directory / "results.h5");
    EXPECT_FALSE(file.has("/cracks/000001"));
    EXPECT_EQ(file.numbers("/cracks/000002/bonds"), (std::vector<double>{0, 3, 1, 3}));
    EXPECT_EQ(file.numbers("/cracks/000003/bonds"), (std::vector<double>{0, 3, 1, 3, 0, 5}));
    EXPECT_EQ(file.numbers("/cracks/000003/step"), (std::vector<double>{2, 2, 3}));
  }
}

TEST_F(ResultsTest, VtkHdfShowsAllStepsTheLastOneFirst) {
  for (const int dimension : {1, 2, 3}) {
    for (const bool closed : {false, true}) {
      {
        Results results = open_results(directory, dimension);
        for (const int step : {1, 2, 3}) add_step(results, step, dimension);
        if (closed) results.close({});
      }
      const Reader file(directory / "results.vtkhdf");
      EXPECT_EQ(file.numbers("/VTKHDF/Steps/Values"), (std::vector<double>{1, 2, 3}));
      const std::vector<double> first = file.numbers("/VTKHDF/Steps/CellDataOffsets/damage");
      EXPECT_EQ(first.back(), 0.0);  // which readers without steps show
      const std::vector<double> damage = file.numbers("/VTKHDF/CellData/damage"),
                                moved = file.numbers("/VTKHDF/CellData/displacement");
      ASSERT_EQ(damage.size(), 3u * count);
      ASSERT_EQ(moved.size(), 9u * count);
      for (const int step : {1, 2, 3}) {
        const ExampleFields fields(step, dimension);
        const auto row = std::size_t(first.at(std::size_t(step) - 1));
        for (std::size_t i = 0; i < std::size_t(count); ++i) {
          EXPECT_EQ(damage[row + i], fields.damage[i]);
          for (std::size_t c = 0; c < 3; ++c) {
            const auto d = std::size_t(dimension);
            EXPECT_EQ(moved[3 * (row + i) + c], c < d ? fields.displacement[d * i + c] : 0.0);
          }
        }
      }
      EXPECT_EQ(file.numbers("/VTKHDF/CellData/volume"), example_points(dimension).volume);
      EXPECT_EQ(file.shape("/VTKHDF/Points"), (std::vector<hsize_t>{count, 3}));
      EXPECT_EQ(file.numbers("/VTKHDF/Types"), std::vector<double>(count, 1.0));
    }
  }
}

TEST_F(ResultsTest, AnEmptyFolderIsAccepted) {
  fs::create_directory(directory);
  Results results = open_results(directory);
  EXPECT_TRUE(Reader(directory / "results.h5").is_open());
}

/// Limits the size of files, which a write then meets as it meets a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    ::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST_F(ResultsTest, AFailedWriteIsReportedAndKeepsWhatWasPublished) {
  Results results = open_results(directory);
  add_step(results, 1);
  add_step(results, 2);
  for (const rlim_t bytes : {0, 1000, 3000, 20000}) {
    const FileSizeLimit limit(bytes);
    try {
      results.add(example_step(static_cast<int>(3 + bytes)), ExampleFields(3, 2).views());
      ADD_FAILURE() << "a full disk at " << bytes << " bytes was not reported";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(directory.string()), std::string::npos)
          << error.what();
    }
    expect_contents(Reader(directory / "results.h5"), 2);
  }
  EXPECT_EQ(lines(directory / "history.csv").size(), 3u);
  {
    // Room for the summary was set aside; the limit is about what lies beyond it.
    const FileSizeLimit limit(8192);
    results.fail({}, "the disk is full");
  }
  EXPECT_NE(read_text(directory / "summary.json").find("the disk is full"), std::string::npos);
  EXPECT_NE(results.what_is_left().find("2 accepted steps"), std::string::npos);
}

TEST_F(ResultsTest, AFailedGatheringIsReportedAndKeepsTheParts) {
  Results results = open_results(directory);
  add_step(results, 1);
  add_step(results, 2);
  // results.h5 still fits with its links, not with the contents of the parts.
  {
    const FileSizeLimit limit(fs::file_size(directory / "results.h5") + 2000);
    EXPECT_THROW(results.close({}), MachineError);
  }
  expect_contents(Reader(directory / "results.h5"), 2);
  const std::string summary = read_text(directory / "summary.json");
  EXPECT_NE(summary.find("\"status\": \"failed\""), std::string::npos);
  EXPECT_NE(summary.find("parts/"), std::string::npos);
  EXPECT_FALSE(fs::exists(directory / "results.h5.tmp"));
}

TEST_F(ResultsTest, AFolderThatDisappearsIsReported) {
  Results results = open_results(directory);
  add_step(results, 1);
  fs::remove_all(directory);
  EXPECT_THROW(results.add(example_step(2), ExampleFields(2, 2).views()), MachineError);
  EXPECT_NE(results.what_is_left().find("has been removed"), std::string::npos);
}

/// An accepted step of a run, told by the child that is going to be killed.
struct Announcement {
  int run = 0, step = 0;
};

fs::path run_folder(const fs::path& base, int run) { return base / ("run" + std::to_string(run)); }

/// Adds steps until it is killed and announces each accepted step. Every 20 steps it closes the
/// results and starts another run, so that kills meet the closing as well.
[[noreturn]] void add_steps_forever(const fs::path& base, int pipe) {
  for (int run = 0;; ++run) {
    Results results = open_results(run_folder(base, run));
    for (int step = 1; step <= 20; ++step) {
      add_step(results, step);
      const Announcement accepted{run, step};
      if (::write(pipe, &accepted, sizeof accepted) != sizeof accepted) _exit(1);
    }
    results.close({});
  }
}

TEST_F(ResultsTest, AKillLeavesEveryAnnouncedStep) {
  int most_steps = 0;
  for (int kill = 0; kill < 30; ++kill) {
    const fs::path place = base / ("kill" + std::to_string(kill));
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      ::close(ends[0]);
      add_steps_forever(place, ends[1]);
    }
    ::close(ends[1]);
    Announcement last, next;
    ASSERT_EQ(::read(ends[0], &last, sizeof last), static_cast<ssize_t>(sizeof last));
    std::this_thread::sleep_for(std::chrono::microseconds(1700 * kill));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    while (::read(ends[0], &next, sizeof next) == static_cast<ssize_t>(sizeof next)) last = next;
    ::close(ends[0]);
    const fs::path folder = run_folder(place, last.run);
    const int announced = last.step;
    most_steps = std::max(most_steps, announced);

    const Reader file(folder / "results.h5");
    ASSERT_TRUE(file.is_open()) << folder;
    const std::vector<double> steps = file.numbers("/history/step");
    ASSERT_GE(steps.size(), static_cast<std::size_t>(announced)) << folder;
    for (int accepted = 1; accepted <= announced; ++accepted) {
      EXPECT_EQ(steps[accepted - 1], accepted);
      expect_step(file, accepted, 2);
    }
    EXPECT_EQ(file.numbers("/iterations/step").size(), 2 * steps.size());
    EXPECT_EQ(file.numbers("/points/volume"), example_points(2).volume);

    for (const auto& [name, columns] : std::map<std::string, int>{
             {"history.csv", 32}, {"iterations.csv", 13}, {"decisions.csv", 8}}) {
      EXPECT_EQ(read_text(folder / name).back(), '\n') << name;
      const std::vector<std::string> rows = lines(folder / name);
      ASSERT_GE(rows.size(), 1u + announced) << name;
      for (const std::string& row : rows) {
        const std::string bare = std::regex_replace(row, std::regex("\"([^\"]|\"\")*\""), "text");
        EXPECT_EQ(std::count(bare.begin(), bare.end(), ','), columns - 1) << name << ": " << row;
      }
    }
  }
  EXPECT_GT(most_steps, 2) << "the kills came too early to mean anything";
}

}  // namespace
}  // namespace peristat
