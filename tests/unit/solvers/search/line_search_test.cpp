#include "solvers/search/line_search.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/search/newton.hpp"
#include "tests/problems.hpp"

namespace peristat {
namespace {

using tests::Problem;

/// A held body under a body force, with the Newton direction of a state.
struct Search {
  Problem problem;
  std::vector<double> external_force;
  Trial from, trial;
  std::vector<double> direction;
  LineSearchOptions options;

  explicit Search(int dimension, const char* force = "1e-3")
      : problem(tests::small_box(dimension), {tests::support("left", "0", "0", "0")},
                {tests::body_force("all", force)}),
        external_force(problem.body.dofs()),
        direction(problem.body.dofs()) {
    problem.conditions.external_force(1.0, external_force);
    from.displacement = problem.at_rest().displacement;
    from.gradient.resize(problem.body.dofs());
    trial = from;
    linearise();
  }

  void linearise() {
    evaluate(problem.equilibrium, external_force, from);
    Cholesky solver;
    EXPECT_EQ(problem.analyze(solver), LinearOutcome::solved);
    problem.assembler.tangent(from.displacement, problem.tangent);
    EXPECT_EQ(solver.factorize(problem.tangent, FactorUse::factorize_now), LinearOutcome::solved);
    std::vector<double> residual(std::size_t(problem.free.count())), solution(residual.size()),
        full(problem.body.dofs());
    for (std::size_t k = 0; k < full.size(); ++k) full[k] = external_force[k] - from.gradient[k];
    problem.free.restrict_to_free(full, residual);
    EXPECT_EQ(solver.solve(residual, solution, 1e-12), LinearOutcome::solved);
    problem.free.extend_by_zero(solution, direction);
  }

  void scale_direction(double factor) {
    for (double& entry : direction) entry *= factor;
  }

  LineSearchResult search() {
    return line_search(problem.equilibrium, external_force, from, direction, options, trial);
  }
};

TEST(LineSearch, TakesTheWholeNewtonStepOfAQuadraticEnergy) {
  Search search(1);  // in 1D the harmonic bond energy is quadratic
  const LineSearchResult result = search.search();
  EXPECT_EQ(result.outcome, Outcome::converged);
  EXPECT_EQ(result.step_length, 1.0);
  EXPECT_LT(search.trial.residual_norm, 1e-10 * search.from.residual_norm);
  EXPECT_GT(search.from.residual_norm, 0.0);
}

TEST(LineSearch, BacksOffUntilTheEnergyFalls) {
  // Along t times the Newton step a quadratic energy is proportional to t^2/2 - t: it rises at
  // t = 3 and falls at 1.5; at 9 it takes three halvings, to 9/8.
  for (const auto& [factor, expected] :
       {std::pair{3.0, 0.5}, std::pair{9.0, 0.125}, std::pair{1.9, 1.0}}) {
    Search search(1);
    search.scale_direction(factor);
    const LineSearchResult result = search.search();
    EXPECT_EQ(result.outcome, Outcome::converged);
    EXPECT_EQ(result.step_length, expected) << factor;
    EXPECT_LT(search.trial.total_energy, search.from.total_energy);
    for (std::size_t k = 0; k < search.direction.size(); ++k) {
      EXPECT_DOUBLE_EQ(search.trial.displacement[k], expected * search.direction[k]);
    }
  }
}

TEST(LineSearch, DemandsASufficientDecrease) {
  // At t = 2 - d the energy is (t^2/2 - t) = -d + d^2/2 times the predicted 1 per unit length: less
  // than the demanded share for a small d.
  Search search(1);
  search.scale_direction(1.999);
  search.options.sufficient_decrease = 0.01;
  EXPECT_EQ(search.search().step_length, 0.5);
  Search lenient(1);
  lenient.scale_direction(1.999);
  EXPECT_EQ(lenient.search().step_length, 1.0);
}

TEST(LineSearch, RefusesAscent) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    Search search(dimension);
    search.scale_direction(-1.0);
    const LineSearchResult result = search.search();
    EXPECT_EQ(result.outcome, Outcome::no_descent);
    EXPECT_EQ(result.step_length, 0.0);
  }
}

TEST(LineSearch, GivesUpAfterItsTrials) {
  Search search(1);
  search.scale_direction(1e3);
  search.options.max_trials = 4;
  EXPECT_EQ(search.search().outcome, Outcome::line_search_failed);
}

TEST(LineSearch, AcceptsChangesAtTheLevelOfRoundOff) {
  // From an equilibrium up to round-off the next Newton step changes the energy by less than its
  // round-off, upwards or downwards; it is taken all the same if the slope has fallen.
  Search search(2, "3e-3");
  const double first_residual = search.from.residual_norm;
  int drowned = 0;
  for (int step = 0; step < 8; ++step) {
    const LineSearchResult result = search.search();
    ASSERT_EQ(result.outcome, Outcome::converged) << "step " << step;
    if (step > 0) {
      EXPECT_EQ(result.step_length, 1.0);
    }
    const double slope = tests::dot(search.direction, search.from.gradient) -
                         tests::dot(search.direction, search.external_force);
    const double energy_round_off =
        std::numeric_limits<double>::epsilon() * std::abs(search.from.stored_energy);
    drowned += std::abs(slope) < energy_round_off;
    if (search.trial.residual_norm < 1e-12 * first_residual) break;
    search.from = search.trial;
    search.linearise();
  }
  EXPECT_LT(search.trial.residual_norm, 1e-12 * first_residual);
  EXPECT_GE(drowned, 1);
}

TEST(LineSearch, StepsBackFromADegenerateState) {
  // The direction drives one point onto its neighbour at full length.
  Search search(1);
  const Points& points = search.problem.body.points;
  const Index i = points.count() / 2;
  const Index j = search.problem.body.model.bonds().of(i)[0];
  std::fill(search.direction.begin(), search.direction.end(), 0.0);
  search.direction[i] = points.position(j)[0] - points.position(i)[0];
  // A force that asks for it, so strong that the energy falls along it.
  search.external_force.assign(search.external_force.size(), 0.0);
  search.external_force[i] = search.direction[i] > 0.0 ? 1e3 : -1e3;
  evaluate(search.problem.equilibrium, search.external_force, search.from);
  const LineSearchResult result = search.search();
  EXPECT_EQ(result.outcome, Outcome::converged);
  EXPECT_EQ(result.step_length, 0.5);
  EXPECT_FALSE(search.trial.degenerate);

  search.options.max_trials = 1;
  EXPECT_EQ(search.search().outcome, Outcome::degenerate);
}

TEST(LineSearch, ReportsADirectionThatIsNotFinite) {
  Search search(2);
  search.direction.back() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(search.search().outcome, Outcome::degenerate);
}

}  // namespace
}  // namespace peristat
