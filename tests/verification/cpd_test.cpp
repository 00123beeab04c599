// Continuum-kinematics-inspired peridynamics: published convergence, large extensions, Poisson's
// ratios.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/formulations/cpd/cpd_model.hpp"
#include "solvers/observe/probe.hpp"
#include "src/core/number_text.hpp"
#include "tests/verification/solved_case.hpp"

namespace peristat {
namespace {

using Overrides = std::vector<std::pair<std::string, std::string>>;

/// Residuals of every step over that right after its jump.
std::vector<std::vector<double>> residual_ratios(const SolvedCase& solved) {
  std::vector<std::vector<double>> ratios(solved.steps.size());
  for (const IterationRecord& row : solved.iterations) {
    std::vector<double>& of_step = ratios.at(std::size_t(row.step - 1));
    of_step.push_back(row.residual);
  }
  for (auto& of_step : ratios) {
    for (std::size_t k = of_step.size(); k-- > 0;) of_step[k] /= of_step[0];
  }
  return ratios;
}

struct InteractionTypes {
  std::string name, c2, c3;
  double least_first, most_first;  ///< bounds of the first ratio at increment 1
};

void PrintTo(const InteractionTypes& types, std::ostream* out) { *out << types.name; }

class Table3 : public ::testing::TestWithParam<InteractionTypes> {};

// Table 3 of [CPD]: 1, 8.97e-2, 1.14e-3, 2.41e-7 in increment 1 (one neighbour), 8.23e-2 (one and
// two). Its set-up is not printed; the bounds of the first ratio are some per cent about it.
TEST_P(Table3, ConvergesQuadraticallyInEveryIncrement) {
  const InteractionTypes& types = GetParam();
  const SolvedCase solved =
      solve_case("cpd/table3.toml", {{"material.c2", types.c2}, {"material.c3", types.c3}});
  ASSERT_EQ(solved.result.outcome, Outcome::converged);
  ASSERT_EQ(solved.steps.size(), 25u);
  std::vector<std::string> kinds;
  for (const auto& term : solved.body->model.terms()) {
    for (const InteractionCount& kind : term->counts()) kinds.push_back(kind.name);
  }
  std::vector<std::string> expected{"bonds"};
  if (types.c2 != "0.0") expected.push_back("triangles");
  if (types.c3 != "0.0") expected.push_back("tetrahedra");
  EXPECT_EQ(kinds, expected);
  const auto ratios = residual_ratios(solved);
  EXPECT_GT(ratios[0][1], types.least_first);
  EXPECT_LT(ratios[0][1], types.most_first);
  for (std::size_t step = 0; step < ratios.size(); ++step) {
    const std::vector<double>& r = ratios[step];
    EXPECT_LE(r.back(), 1e-12) << "increment " << step + 1;
    // With triangles the last increments come close to a fold and converge later, as in the table.
    const bool near_fold = types.c2 != "0.0" && step >= 23;
    EXPECT_LE(r.size() - 1, near_fold ? 7u : 5u) << "increment " << step + 1;
    // r_(k+1) <= C r_k^2 down to round-off, with one C: its size is that of the second iteration.
    for (std::size_t k = 1; k + 1 < r.size(); ++k) {
      if (r[k] > 0.1 || r[k + 1] < 1e-13) continue;
      EXPECT_LE(r[k + 1], 20.0 * r[k] * r[k])
          << "increment " << step + 1 << ", iteration " << k + 1;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    InteractionTypes, Table3,
    ::testing::Values(InteractionTypes{"One", "0.0", "0.0", 0.085, 0.095},
                      InteractionTypes{"OneAndTwo", "51.0", "0.0", 0.078, 0.09},
                      InteractionTypes{"OneAndThree", "0.0", "1.0", 0.085, 0.095}),
    [](const auto& type) { return type.param.name; });

double relative_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0.0, size = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    difference += (a[k] - b[k]) * (a[k] - b[k]);
    size += b[k] * b[k];
  }
  return std::sqrt(difference / size);
}

TEST(Cube, PulledToTwiceItsLengthInOneIncrementIsThatOf25) {
  // Half the resolution of the shipped case; constants that keep the ratios of the moduli.
  int projected = 0;
  for (const auto& [c2, c3] :
       {std::pair{"0.0", "0.0"}, std::pair{"125.0", "0.0"}, std::pair{"0.0", "4e4"}}) {
    const Overrides overrides{{"lattice.spacing", "0.1"}, {"material.c2", c2}, {"material.c3", c3}};
    Overrides one = overrides;
    one.emplace_back("loading.steps", "1");
    one.emplace_back("loading.adaptive", "false");
    const SolvedCase at_once = solve_case("cpd/cube.toml", one);
    const SolvedCase stepwise = solve_case("cpd/cube.toml", overrides);
    ASSERT_EQ(at_once.result.outcome, Outcome::converged);
    ASSERT_EQ(stepwise.result.outcome, Outcome::converged);
    ASSERT_EQ(at_once.steps.size(), 1u);
    ASSERT_EQ(stepwise.steps.size(), 25u);
    EXPECT_LT(
        relative_distance(at_once.result.state.displacement, stepwise.result.state.displacement),
        1e-8)
        << "c2 " << c2 << ", c3 " << c3;
    for (const IterationRecord& row : at_once.iterations) projected += row.projection > 0.0;
  }
  EXPECT_GT(projected, 0);  // so that this says something about the globalisation
}

TEST(Square, ConvergesForEveryRatioOfConstants) {
  double stored = 0.0;
  for (const char* c2 : {"0.0", "0.5", "1.0", "50.0", "1200.0", "4000.0"}) {
    for (const char* name : {"cpd/square.toml", "cpd/square_hole.toml"}) {
      const SolvedCase solved = solve_case(name, {{"material.c2", c2}});
      EXPECT_EQ(solved.result.outcome, Outcome::converged) << name << ", c2 " << c2;
      EXPECT_EQ(solved.result.state.stage, 1.0);
      if (std::string(name) == "cpd/square.toml") {
        EXPECT_GT(solved.steps.back().stored_energy, stored);  // stiffer with every triangle
        stored = solved.steps.back().stored_energy;
      }
    }
  }
}

TEST(Square, BeyondTheStableRangeIsNamedUnstable) {
  const SolvedCase solved =
      solve_case("cpd/square.toml", {{"material.c2", "-2000.0"}, {"lattice.spacing", "0.05"}});
  EXPECT_EQ(solved.result.outcome, Outcome::not_positive_definite);
  EXPECT_TRUE(solved.result.last_attempt.unstable_start);
  EXPECT_EQ(solved.steps.size(), 0u);
  ASSERT_TRUE(solved.result.last_attempt.inertia);
  EXPECT_GT(solved.result.last_attempt.inertia->negative, 0);
}

struct PoissonCase {
  std::string file;
  double poisson_ratio;  ///< of the isotropic part
  double tolerance = 0.02;
};

void PrintTo(const PoissonCase& wanted, std::ostream* out) {
  *out << wanted.file << " with Poisson's ratio " << wanted.poisson_ratio;
}

/// Overrides that give a case the constants of a Poisson's ratio on its own lattice.
Overrides constants_for(const PoissonCase& wanted) {
  const Case from = read_case(std::string(PERISTAT_SOURCE_DIR "/cases/") + wanted.file);
  const auto& lattice = std::get<Lattice>(from.body);
  const CpdStiffness stiffness =
      lattice_stiffness(from.dimension, lattice.spacing, from.horizon_ratio * lattice.spacing, 1.0);
  const CpdConstants constants =
      stiffness.constants(lame_moduli(1.0, wanted.poisson_ratio, from.dimension), 0.0);
  return {{"material.c1", number_text(constants.c1)},
          {"material.c2", number_text(constants.c2)},
          {"material.c3", number_text(constants.c3)}};
}

double measured_poisson_ratio(const SolvedCase& solved) {
  const ProbeSpecification& probe = solved.from.probes.at(0);
  EXPECT_EQ(probe.name, "poisson_ratio");
  return probe_values(probe, solved.body->points,
                      {{"displacement", solved.result.state.displacement}}, {})
      .at(0);
}

double axis_poisson_ratio(const SolvedCase& solved) {
  const Points& points = solved.body->points;
  const BondSetting& setting = solved.body->setting;
  const CpdConstants constants =
      cpd_constants_of(solved.from.material, "material", setting, points.spacing);
  return lattice_stiffness(points.dimension, points.spacing, setting.horizon, setting.cross_section)
      .elasticity(constants)
      .axis_poisson_ratio(points.dimension);
}

class Poisson : public ::testing::TestWithParam<PoissonCase> {};

// A pull along an axis of the lattice, ends free to contract: the ratio is c12/c11 (2D) or
// c12/(c11 + c12) (3D) of the lattice's bulk. Surfaces are softer or stiffer than the bulk over a
// horizon's depth and leave some hundredths in the middle, and more in an auxetic body of 15^3
// points, whose skin (with fewer tetrahedra of negative stiffness) does not want to expand.
TEST_P(Poisson, RatioOfThePulledBodyIsThatOfTheLatticesBulk) {
  const SolvedCase solved = solve_case(GetParam().file, constants_for(GetParam()));
  ASSERT_EQ(solved.result.outcome, Outcome::converged);
  EXPECT_NEAR(measured_poisson_ratio(solved), axis_poisson_ratio(solved), GetParam().tolerance);
  // The isotropic part is what was asked for; the lattice's anisotropy moves the axes' away from
  // it.
  EXPECT_NEAR(axis_poisson_ratio(solved), GetParam().poisson_ratio, 0.06);
}

INSTANTIATE_TEST_SUITE_P(AuxeticToNearlyIncompressible, Poisson,
                         ::testing::Values(PoissonCase{"cpd/poisson_2d.toml", -0.3},
                                           PoissonCase{"cpd/poisson_2d.toml", 0.0},
                                           PoissonCase{"cpd/poisson_2d.toml", 0.6},
                                           PoissonCase{"cpd/poisson_2d.toml", 0.95},
                                           PoissonCase{"cpd/poisson_3d.toml", -0.2, 0.1},
                                           PoissonCase{"cpd/poisson_3d.toml", 0.1},
                                           PoissonCase{"cpd/poisson_3d.toml", 0.4},
                                           PoissonCase{"cpd/poisson_3d.toml", 0.48}),
                         [](const auto& number) {
                           const double ratio = number.param.poisson_ratio;
                           const auto digits = std::lround(100.0 * std::abs(ratio));
                           return (number.param.file == "cpd/poisson_2d.toml" ? "Plane" : "Space") +
                                  std::string(ratio < 0.0 ? "Minus" : "") + std::to_string(digits) +
                                  "Percent";
                         });

}  // namespace
}  // namespace peristat
