// Runs with functions and points that a program gives: resumed there, and nowhere else.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "cases/runner/commands/resume.hpp"
#include "cases/runner/commands/run.hpp"
#include "cases/runner/input/case.hpp"
#include "src/core/input_error.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

namespace fs = std::filesystem;

const std::string text = R"case(dimension = 2
[points]
horizon = 3.015e-3
thickness = 1e-3
[material]
youngs_modulus = 70e9
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["pulled(y, load)", 0]
[loading]
steps = 4
)case";

class GivenRun : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("peristat_given_" + std::to_string(std::random_device{}()));
    fs::create_directories(folder_);
    std::ofstream(folder_ / "case.toml") << text;
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] Case read(const std::string& name,
                          const std::shared_ptr<const Givens>& givens) const {
    return read_case(folder_ / "case.toml", text, {{"output.directory", (folder_ / name).string()}},
                     givens);
  }
  [[nodiscard]] std::string history(const std::string& name) const {
    std::ifstream file(folder_ / name / "load_displacement.csv");
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] static Exit go_on(const fs::path& folder,
                                  const std::shared_ptr<const Givens>& givens) {
    RunOptions options;
    options.quiet = true;
    return resume(folder, {}, options, SoleRank(), givens);
  }

  fs::path folder_;
  RunOptions quiet_ = [] {
    RunOptions options;
    options.quiet = true;
    return options;
  }();
};

std::shared_ptr<const Givens> givens_with(double size = 1e-3, double fails_beyond = 2.0) {
  Givens givens;
  givens.functions["pulled"] = {
      2, [=](std::span<const std::span<const double>> arguments, std::span<double> values) {
        const double load = arguments[1][0];
        if (load > fails_beyond) throw std::out_of_range("of the program");
        for (std::size_t k = 0; k < values.size(); ++k)
          values[k] = 1e-6 * load * (1.0 + 10.0 * arguments[0][k]);
      }};
  Points points;
  points.dimension = 2;
  for (int k = 0; k < 120; ++k) {
    const double x = k / 10, y = k % 10;
    points.reference.insert(points.reference.end(), {size * x, size * y});
    points.volume.push_back(1e-9);
    if (x < 3) points.sets["left"].push_back(k);
    if (x > 8) points.sets["right"].push_back(k);
  }
  givens.points = std::move(points);
  return std::make_shared<const Givens>(std::move(givens));
}

TEST_F(GivenRun, IsResumedToTheSameBits) {
  ASSERT_EQ(run(read("whole", givens_with()), quiet_, SoleRank()), Exit::done);
  RunOptions two_steps = quiet_;
  two_steps.steps = 2;
  ASSERT_EQ(run(read("parts", givens_with()), two_steps, SoleRank()), Exit::interrupted);
  EXPECT_NE(history("parts"), history("whole"));
  ASSERT_EQ(go_on(folder_ / "parts", givens_with()), Exit::done);
  EXPECT_EQ(history("parts"), history("whole"));
  EXPECT_GT(history("whole").size(), 100u);
}

TEST_F(GivenRun, IsRefusedWithoutWhatWasGiven) {
  RunOptions one_step = quiet_;
  one_step.steps = 1;
  ASSERT_EQ(run(read("parts", givens_with()), one_step, SoleRank()), Exit::interrupted);
  const auto refused = [&](const std::shared_ptr<const Givens>& givens) -> std::string {
    try {
      static_cast<void>(go_on(folder_ / "parts", givens));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(refused(std::make_shared<const Givens>())
                .find("this run used functions or points of a program: function pulled, points. "
                      "Resume it in a program that gives them"),
            std::string::npos);
  EXPECT_NE(refused(givens_with(0.999e-3)).find("its points differ from those"), std::string::npos);
  EXPECT_EQ(refused(givens_with()), "accepted");
}

TEST_F(GivenRun, PassesOnWhatAFunctionThrows) {
  const RunCompany company;
  RunOptions in_company = quiet_;
  in_company.company = &company;
  EXPECT_THROW(
      static_cast<void>(run(read("failed", givens_with(1e-3, 0.6)), in_company, SoleRank())),
      std::out_of_range);
}

}  // namespace
}  // namespace peristat
