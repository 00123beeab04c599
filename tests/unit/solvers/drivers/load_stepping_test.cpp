#include "solvers/drivers/load_stepping.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/terms/damage.hpp"
#include "tests/softening_strip.hpp"

namespace peristat {
namespace {

using tests::critical;
using tests::drawn;
using tests::Problem;
using tests::Strip;
using tests::support;

struct Followed {
  LoadSteppingResult result;
  std::vector<StepRecord> at_load_zero;  // step 0, once
  std::vector<StepRecord> steps;         // after it
  std::vector<IterationRecord> iterations;
  std::vector<DecisionRecord> decisions;
  std::vector<std::vector<double>> displacements;
  std::vector<std::vector<double>> histories;     // of the bonds at accepted states
  std::vector<std::vector<std::int32_t>> pieces;  // at accepted states
};

/// @param problem with a body, conditions, an assembler and a tangent
template <class AnyProblem>
Followed follow(AnyProblem& problem, const LoadSteppingOptions& options,
                const NewtonOptions& newton_options = {}, int interrupt_after = -1) {
  Followed followed;
  Cholesky solver;
  EXPECT_EQ(problem.analyze(solver), LinearOutcome::solved);
  LoadSteppingObserver observer;
  observer.iteration = [&](const IterationRecord& row) { followed.iterations.push_back(row); };
  observer.decision = [&](const DecisionRecord& row) { followed.decisions.push_back(row); };
  observer.accepted = [&](const StepRecord& row, const AcceptedState& state) {
    if (row.step == 0) return followed.at_load_zero.push_back(row);
    followed.steps.push_back(row);
    followed.displacements.push_back(state.trial.displacement);
    const std::span<const double> stretches =
        bond_stretches(problem.assembler.model(), state.trial.history);
    followed.histories.emplace_back(stretches.begin(), stretches.end());
    followed.pieces.emplace_back(state.piece.begin(), state.piece.end());
  };
  observer.interrupted = [&] { return int(followed.steps.size()) == interrupt_after; };
  followed.result = follow_loading({{problem.assembler, solver, problem.tangent, problem.free},
                                    problem.conditions,
                                    options,
                                    newton_options,
                                    observer});
  return followed;
}

/// Held on the left; the right end moves along x by `stretch` of the length, and half as much
/// across.
std::vector<SupportSpecification> pulled(const tests::BoxSetting& box, double stretch,
                                         const std::string& program = "load") {
  const double length = box.extent[0] * box.spacing;
  const std::string along = std::to_string(stretch * length) + "*" + program;
  const std::string across = std::to_string(0.5 * stretch * length) + "*" + program;
  return {support("left", "0", "0", "0"), support("right", along, across, "0")};
}

LoadSteppingOptions steps(int count) {
  LoadSteppingOptions options;
  options.steps = count;
  return options;
}

bool is_accepted(const DecisionRecord& decision) {
  return decision.action == Decision::accept || decision.action == Decision::accept_and_grow ||
         decision.action == Decision::accept_at_round_off;
}

/// What every run must satisfy: accepted load factors rise, each decision continues the last.
void expect_consistent(const Followed& followed) {
  ASSERT_EQ(followed.at_load_zero.size(), 1u);
  ASSERT_EQ(followed.result.steps, int(followed.steps.size()));
  double reached = 0.0;
  std::size_t accepted = 0;
  for (const DecisionRecord& decision : followed.decisions) {
    EXPECT_EQ(decision.step, int(accepted) + 1);
    EXPECT_NEAR(decision.load_factor, reached + decision.increment, 1e-12);
    EXPECT_FALSE(decision.reason.empty());
    if (!is_accepted(decision)) continue;
    EXPECT_EQ(decision.outcome, "converged");
    ASSERT_LT(accepted, followed.steps.size());
    EXPECT_EQ(followed.steps[accepted].load_factor, decision.load_factor);
    EXPECT_EQ(followed.steps[accepted].step, int(accepted) + 1);
    EXPECT_GT(decision.load_factor, reached);
    reached = decision.load_factor;
    ++accepted;
  }
  EXPECT_EQ(accepted, followed.steps.size());
  EXPECT_EQ(followed.result.state.stage, reached);
  if (accepted > 0) {
    EXPECT_EQ(followed.result.state.displacement, followed.displacements.back());
  }
}

TEST(LoadStepping, TakesEqualStepsToTheFullLoad) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.05), {});
  for (int count : {1, 3, 7}) {
    const Followed followed = follow(problem, steps(count));
    ASSERT_EQ(followed.result.outcome, Outcome::converged);
    expect_consistent(followed);
    ASSERT_EQ(followed.steps.size(), std::size_t(count));
    for (int k = 0; k < count; ++k) {
      EXPECT_NEAR(followed.steps[k].load_factor, double(k + 1) / count, 1e-14);
      EXPECT_EQ(followed.steps[k].mode, "newton");
      EXPECT_GT(followed.steps[k].newton_iterations, 0);
    }
    EXPECT_EQ(followed.steps.back().load_factor, 1.0);  // exactly
    EXPECT_EQ(followed.iterations.front().step, 1);
    EXPECT_EQ(followed.iterations.back().step, count);
  }
}

// Three iterations are too few for the whole load and enough for a part of it; later parts, which
// move less, are easier.
TEST(LoadStepping, CutsAStepThatFailsAndGrowsItAgain) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.3, "sqrt(load)"), {});
  LoadSteppingOptions options = steps(1);
  options.easy_iterations = 3;
  NewtonOptions newton_options;
  newton_options.max_iterations = 3;
  const Followed followed = follow(problem, options, newton_options);
  ASSERT_EQ(followed.result.outcome, Outcome::converged);
  expect_consistent(followed);
  int cuts = 0, grown = 0;
  double increment = 1.0;
  for (const DecisionRecord& decision : followed.decisions) {
    EXPECT_LE(decision.increment, increment);  // less where only a rest is left
    increment = decision.next_increment;
    if (decision.action == Decision::cut) {
      ++cuts;
      EXPECT_EQ(decision.outcome, "iteration_limit");
      EXPECT_DOUBLE_EQ(decision.next_increment, 0.5 * decision.increment);
    } else if (decision.action == Decision::accept_and_grow) {
      ++grown;
      EXPECT_GT(cuts, 0);
    }
  }
  EXPECT_GE(cuts, 2);
  EXPECT_GE(grown, 1);
  EXPECT_EQ(followed.steps.back().load_factor, 1.0);

  // However it was reached, the equilibrium is that of one large step with enough iterations.
  const Followed at_once = follow(problem, steps(1));
  ASSERT_EQ(at_once.steps.size(), 1u);
  EXPECT_LT(tests::distance(followed.displacements.back(), at_once.displacements.back()),
            1e-8 * tests::norm(at_once.displacements.back()));
}

TEST(LoadStepping, NeverGrowsBeyondTheLargestStep) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.05), {});
  LoadSteppingOptions options = steps(16);
  options.largest_step = 0.25;
  options.easy_iterations = 100;
  const Followed followed = follow(problem, options);
  ASSERT_EQ(followed.result.outcome, Outcome::converged);
  expect_consistent(followed);
  double largest = 0.0;
  for (const DecisionRecord& decision : followed.decisions) {
    largest = std::max(largest, decision.increment);
  }
  EXPECT_EQ(largest, 0.25);
  // 1/16 + 1/8 + 1/4 + 1/4 + 1/4 and the rest of 1/16
  EXPECT_EQ(followed.steps.size(), 6u);

  options.largest_step = 0.03;  // also below 1 / steps
  EXPECT_EQ(follow(problem, options).steps.size(), 34u);
}

TEST(LoadStepping, StopsBelowTheSmallestStepWithTheOutcomesName) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.3), {});
  LoadSteppingOptions options = steps(1);
  options.smallest_step = 0.2;
  NewtonOptions newton_options;
  newton_options.max_iterations = 1;
  const Followed followed = follow(problem, options, newton_options);
  EXPECT_EQ(followed.result.outcome, Outcome::iteration_limit);
  EXPECT_EQ(followed.result.steps, 0);
  expect_consistent(followed);
  ASSERT_EQ(followed.decisions.size(), 3u);  // 1, 1/2, 1/4; an eighth is too small
  EXPECT_EQ(followed.decisions[0].action, Decision::cut);
  EXPECT_EQ(followed.decisions[1].action, Decision::cut);
  EXPECT_EQ(followed.decisions[2].action, Decision::stop);
  EXPECT_EQ(followed.decisions[2].increment, 0.25);
  EXPECT_EQ(followed.decisions[2].outcome, "iteration_limit");
  EXPECT_NE(followed.decisions[2].reason.find("max_iterations"), std::string::npos);
  EXPECT_EQ(tests::norm(followed.result.state.displacement), 0.0);
}

TEST(LoadStepping, StopsAtTheFirstFailureUnlessAdaptive) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.3), {});
  LoadSteppingOptions options = steps(4);
  options.adaptive = false;
  NewtonOptions newton_options;
  newton_options.max_iterations = 1;
  const Followed followed = follow(problem, options, newton_options);
  EXPECT_EQ(followed.result.outcome, Outcome::iteration_limit);
  ASSERT_EQ(followed.decisions.size(), 1u);
  EXPECT_EQ(followed.decisions[0].action, Decision::stop);
}

TEST(LoadStepping, DoesNotCutWhereASmallerStepCannotHelp) {
  Problem problem(tests::small_box(2), {support("left", "0")},
                  {tests::body_force("right", "1*load", "1*load")});
  const Followed followed = follow(problem, steps(1));
  EXPECT_EQ(followed.result.outcome, Outcome::singular_tangent);
  ASSERT_EQ(followed.decisions.size(), 1u);
  EXPECT_EQ(followed.decisions[0].action, Decision::stop);
  EXPECT_EQ(followed.decisions[0].outcome, "singular_tangent");
}

TEST(LoadStepping, KeepsTheLastAcceptedStateWhenInterrupted) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.05), {});
  const Followed followed = follow(problem, steps(5), {}, 2);
  EXPECT_EQ(followed.result.outcome, Outcome::interrupted);
  EXPECT_EQ(followed.result.steps, 2);
  expect_consistent(followed);
  EXPECT_NEAR(followed.result.state.stage, 0.4, 1e-14);
  EXPECT_EQ(followed.decisions.back().action, Decision::stop);
  EXPECT_EQ(followed.decisions.back().outcome, "interrupted");
}

TEST(LoadStepping, ReactionsBalanceTheLoads) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    Problem problem(tests::small_box(dimension), {support("left", "0", "0", "0")},
                    {tests::body_force("all", "0.01*load", "2e-4*load", "-1e-4*load")});
    const Followed followed = follow(problem, steps(2));
    ASSERT_EQ(followed.result.outcome, Outcome::converged);
    ASSERT_EQ(followed.steps.size(), 2u);
    for (const StepRecord& step : followed.steps) {
      std::vector<double> external(problem.body.dofs());
      problem.conditions.external_force(step.load_factor, external);
      double largest = 0.0;
      for (int c = 0; c < dimension; ++c) {
        double total = 0.0;
        for (std::size_t dof = c; dof < external.size(); dof += dimension) total += external[dof];
        largest = std::max(largest, std::abs(total));
        // 1e-10 of the forces' norm as residual, over some hundred degrees of freedom.
        EXPECT_NEAR(step.reactions.at("left")[c], -total, 1e-9 * largest);
      }
      EXPECT_GT(largest, 0.0);
    }
  }
}

/// Balance error of the first step from the unloaded state to a stretch.
StepRecord single_step(const tests::BoxSetting& box, double stretch, bool by_force) {
  std::vector<SupportSpecification> supports = pulled(box, stretch);
  std::vector<LoadSpecification> loads;
  if (by_force) {
    supports.pop_back();
    loads = {tests::body_force("right", std::to_string(10.0 * stretch) + "*load")};
  }
  Problem problem(box, supports, loads);
  NewtonOptions options;
  options.relative_tolerance = 1e-13;
  const Followed followed = follow(problem, steps(1), options);
  EXPECT_EQ(followed.result.outcome, Outcome::converged);
  return followed.steps.at(0);
}

TEST(LoadStepping, BalanceErrorFallsWithTheCubeOfAnElasticStep) {
  for (int dimension = 2; dimension <= 3; ++dimension) {
    const tests::BoxSetting box = tests::small_box(dimension);
    for (bool by_force : {false, true}) {
      const StepRecord coarse = single_step(box, 0.02, by_force);
      const StepRecord fine = single_step(box, 0.01, by_force);
      ASSERT_GT(coarse.stored_energy, 0.0);
      EXPECT_DOUBLE_EQ(coarse.balance_error, coarse.external_work - coarse.stored_energy);
      ASSERT_GT(std::abs(fine.balance_error), 1e-6 * fine.stored_energy);  // above round-off
      EXPECT_NEAR(std::log2(coarse.balance_error / fine.balance_error), 3.0, 0.1)
          << dimension << "D" << (by_force ? ", by force" : "");
    }
  }
}

TEST(LoadStepping, LedgerOfALinearBodyCloses) {
  // In 1D forces are linear in the displacement, for which the trapezoidal rule is exact.
  const tests::BoxSetting box = tests::small_box(1);
  Problem problem(box, pulled(box, 0.1), {tests::body_force("all", "0.3*load")});
  const Followed followed = follow(problem, steps(3));
  ASSERT_EQ(followed.steps.size(), 3u);
  for (const StepRecord& step : followed.steps) {
    EXPECT_GT(step.stored_energy, 0.0);
    EXPECT_NEAR(step.external_work / step.stored_energy, 1.0, 1e-12);
  }
}

// ---- Damage

LoadSteppingOptions in_mode(Mode mode, int implicit_steps, int relaxation_steps) {
  LoadSteppingOptions options = steps(implicit_steps);
  options.mode = mode;
  options.relaxation_steps = relaxation_steps;
  return options;
}

int count_of(const Followed& followed, Decision action) {
  return int(std::count_if(followed.decisions.begin(), followed.decisions.end(),
                           [&](const DecisionRecord& row) { return row.action == action; }));
}

/// Histories only grow: a broken bond stays broken.
void expect_no_healing(const Followed& followed) {
  ASSERT_EQ(followed.histories.size(), followed.steps.size());
  for (std::size_t k = 1; k < followed.histories.size(); ++k) {
    for (std::size_t b = 0; b < followed.histories[k].size(); ++b) {
      ASSERT_GE(followed.histories[k][b], followed.histories[k - 1][b]) << "step " << k;
    }
    EXPECT_GE(followed.steps[k].broken_bonds, followed.steps[k - 1].broken_bonds);
    // A sum over bonds at displacements that have the round-off of a factorisation.
    const double before = followed.steps[k - 1].dissipated_energy;
    EXPECT_GE(followed.steps[k].dissipated_energy, before * (1.0 - 1e-10));
  }
  for (std::size_t k = 0; k < followed.histories.size(); ++k) {
    const std::vector<double>& history = followed.histories[k];
    EXPECT_EQ(followed.steps[k].broken_bonds,
              std::count_if(history.begin(), history.end(),
                            [](double kappa) { return kappa >= critical; }));
  }
}

/// Every accepted state is one of equilibrium, looked at anew with its history.
void expect_equilibria(const Followed& followed, Strip& strip, double tolerance) {
  std::map<int, double> scale;
  for (const IterationRecord& row : followed.iterations) {
    if (row.relative_residual > 0.0) {
      scale[row.step] = std::max(scale[row.step], row.residual / row.relative_residual);
    }
  }
  Assembler assembler(strip.body.points, strip.body.model, 1);
  std::vector<double> gradient(strip.body.dofs());
  for (std::size_t k = 0; k < followed.steps.size(); ++k) {
    const History history = assembler.history_of(followed.histories[k]);
    (void)assembler.gradient({followed.displacements[k], history}, gradient);
    double squared = 0.0;
    for (const Index dof : strip.free.dof) squared += gradient[dof] * gradient[dof];
    ASSERT_GT(scale[int(k) + 1], 0.0);
    // A sum in the same order as the program's, of nearly the same displacements' forces.
    EXPECT_LE(std::sqrt(squared), 1.01 * tolerance * scale[int(k) + 1]) << "step " << k + 1;
    EXPECT_EQ(assembler.growth({followed.displacements[k], history}).degrading, 0)
        << "step " << k + 1;
  }
}

TEST(LoadStepping, AdaptiveModeRelaxesWhileDamageGrows) {
  // Pulled and then let go.
  Strip strip(Strip::Middle::notched, drawn("0.045*min(load, 1.2 - load)"));
  LoadSteppingOptions options = in_mode(Mode::adaptive, 10, 50);
  const Followed followed = follow(strip, options);
  ASSERT_EQ(followed.result.outcome, Outcome::converged);
  expect_consistent(followed);
  expect_no_healing(followed);
  expect_equilibria(followed, strip, 1e-10);
  EXPECT_EQ(followed.steps.back().load_factor, 1.0);
  EXPECT_GT(followed.steps.back().dissipated_energy, 0.0);
  EXPECT_GT(followed.steps.back().broken_bonds, 0);
  EXPECT_GE(count_of(followed, Decision::hand_over), 1);
  EXPECT_EQ(count_of(followed, Decision::hand_over), count_of(followed, Decision::hand_back));
  // Newton's steps damage nothing; every relaxed one does but the last, after which it hands back.
  std::string mode = "newton";
  std::size_t accepted = 0;
  double dissipated = 0.0;
  for (const DecisionRecord& decision : followed.decisions) {
    if (decision.action == Decision::hand_over) {
      EXPECT_EQ(mode, "newton");
      mode = "relaxation";
    } else if (decision.action == Decision::hand_back) {
      EXPECT_EQ(mode, "relaxation");
      ASSERT_GE(accepted, 2u);
      EXPECT_EQ(followed.histories[accepted - 1], followed.histories[accepted - 2]);
      mode = "newton";
    } else if (is_accepted(decision)) {
      const StepRecord& step = followed.steps.at(accepted);
      EXPECT_EQ(step.mode, mode);
      EXPECT_EQ(step.relaxation_iterations > 0, mode == "relaxation");
      if (mode == "newton") {
        EXPECT_EQ(step.dissipated_energy, dissipated);
      }
      dissipated = step.dissipated_energy;
      ++accepted;
    }
  }
  EXPECT_EQ(mode, "newton");
}

TEST(LoadStepping, FindsThePeakWhateverTheSteps) {
  std::vector<double> peaks;
  for (const RelaxationMethod method : {RelaxationMethod::dynamic, RelaxationMethod::flow}) {
    // Longer steps pass a first, shallow peak without seeing it.
    for (const int relaxed_steps : {20, 40}) {
      SCOPED_TRACE(relaxed_steps);
      Strip strip(Strip::Middle::notched, drawn("0.045*load"));
      LoadSteppingOptions options = in_mode(Mode::adaptive, 10, relaxed_steps);
      options.relaxation.method = method;
      options.peak_tolerance = 1e-3;
      const Followed followed = follow(strip, options);
      ASSERT_EQ(followed.result.outcome, Outcome::converged);
      expect_consistent(followed);
      expect_no_healing(followed);
      expect_equilibria(followed, strip, 1e-10);
      const auto tells_peak = [](const DecisionRecord& decision) {
        return decision.reason.find("the peak of the force lies between") != std::string::npos;
      };
      const auto peak =
          std::find_if(followed.decisions.begin(), followed.decisions.end(), tells_peak);
      ASSERT_NE(peak, followed.decisions.end());
      EXPECT_LE(peak->increment, 1e-3 * (1.0 + 1e-9));
      peaks.push_back(peak->stage);
    }
  }
  // Each lies at the end of a bracket of 1e-3; beyond it the states are the same.
  for (const double peak : peaks) EXPECT_NEAR(peak, peaks.front(), 1e-3);
}

TEST(LoadStepping, AdaptiveModeWithoutDamageIsNewton) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.2), {});
  for (const int max_iterations : {3, 25}) {
    LoadSteppingOptions options = steps(3);
    NewtonOptions newton_options;
    newton_options.max_iterations = max_iterations;
    const Followed newton = follow(problem, options, newton_options);
    options.mode = Mode::adaptive;
    const Followed adaptive = follow(problem, options, newton_options);
    ASSERT_EQ(newton.result.outcome, Outcome::converged);
    ASSERT_EQ(adaptive.result.outcome, Outcome::converged);
    EXPECT_EQ(adaptive.displacements, newton.displacements);
    ASSERT_EQ(adaptive.decisions.size(), newton.decisions.size());
    for (std::size_t k = 0; k < newton.decisions.size(); ++k) {
      EXPECT_EQ(adaptive.decisions[k].action, newton.decisions[k].action);
      EXPECT_EQ(adaptive.decisions[k].load_factor, newton.decisions[k].load_factor);
    }
    for (std::size_t k = 0; k < newton.steps.size(); ++k) {
      EXPECT_EQ(adaptive.steps[k].external_work, newton.steps[k].external_work);
    }
  }
}

TEST(LoadStepping, LedgerOfRelaxationClosesThroughDamage) {
  for (const int threads : {1, 2}) {
    Strip strip(Strip::Middle::notched, drawn("0.03*load"), threads);
    const Followed followed = follow(strip, in_mode(Mode::relaxation, 1, 30));
    ASSERT_EQ(followed.result.outcome, Outcome::converged);
    expect_consistent(followed);
    expect_no_healing(followed);
    expect_equilibria(followed, strip, 1e-10);
    ASSERT_GT(followed.steps.back().broken_bonds, 0);
    for (const StepRecord& step : followed.steps) {
      EXPECT_EQ(step.mode, "relaxation");
      EXPECT_DOUBLE_EQ(step.balance_error, step.external_work + step.numerical_work -
                                               step.stored_energy - step.dissipated_energy -
                                               step.drained_energy);
      EXPECT_LE(std::abs(step.balance_error), 1e-12 * step.external_work);
    }
  }
}

TEST(LoadStepping, TrianglesLoseTheirStiffnessInEquilibrium) {
  // Each loss of a commit lets other bonds take over and is followed to an equilibrium with it.
  for (const Mode mode : {Mode::relaxation, Mode::adaptive}) {
    SCOPED_TRACE(mode.name);
    Strip strip(Strip::Middle::weak, drawn("0.045*load"), 1, 0.2);
    const Followed followed = follow(strip, in_mode(mode, 10, 30));
    ASSERT_EQ(followed.result.outcome, Outcome::converged);
    expect_consistent(followed);
    expect_no_healing(followed);
    expect_equilibria(followed, strip, 1e-10);
    ASSERT_GT(followed.steps.back().broken_bonds, 0);
    // What triangles release with their bonds is booked as dissipated, beside the bonds' own.
    std::vector<double> damage(std::size_t(strip.body.points.count()));
    const DamageState bonds_alone =
        assess_damage(strip.body.model, followed.result.state.history, {}, damage);
    EXPECT_GT(followed.steps.back().dissipated_energy, 1.01 * bonds_alone.dissipated_energy);
    if (mode == Mode::adaptive) continue;  // whose implicit steps' work is a quadrature
    for (const StepRecord& step : followed.steps) {
      EXPECT_LE(std::abs(step.balance_error), 1e-12 * step.external_work);
    }
  }
}

/// Bonds that broke in each accepted step.
std::vector<Index> broken_in_steps(const Followed& followed) {
  std::vector<Index> result;
  Index before = 0;
  for (const StepRecord& step : followed.steps) {
    result.push_back(step.broken_bonds - before);
    before = step.broken_bonds;
  }
  return result;
}

TEST(LoadStepping, CutsStepsInWhichTooManyBondsBreak) {
  // All points move along x so that bonds are stretched by the more the further they are to the
  // right: they break column by column, at loads that are close where columns of bonds are equal.
  // Nothing is free to jump as they do.
  const std::vector<SupportSpecification> supports{support("all", "0.04*load*x*x", "0")};
  LoadSteppingOptions options = steps(4);
  options.smallest_step = 1e-3;
  for (const int limit : {40, 1}) {
    SCOPED_TRACE(limit);
    Strip strip(Strip::Middle::notched, supports);
    options.max_broken_bonds = limit;
    const Followed followed = follow(strip, options);
    expect_consistent(followed);
    expect_no_healing(followed);
    for (const Index broken : broken_in_steps(followed)) EXPECT_LE(broken, limit);
    int cuts = 0;  // for broken bonds; softening ones make searches fail, too
    for (const DecisionRecord& decision : followed.decisions) {
      if (decision.action != Decision::cut) continue;
      cuts += decision.outcome == "damage_limit";
      EXPECT_DOUBLE_EQ(decision.next_increment, 0.5 * decision.increment);
    }
    EXPECT_GE(cuts, 1);
    if (limit == 40) {
      EXPECT_EQ(followed.result.outcome, Outcome::converged);
      EXPECT_GT(followed.steps.back().broken_bonds, limit);
    } else {
      // The bonds of a column break at the same load, however small the step.
      EXPECT_EQ(followed.result.outcome, Outcome::damage_limit);
      EXPECT_EQ(followed.decisions.back().action, Decision::stop);
      EXPECT_EQ(followed.decisions.back().outcome, "damage_limit");
      EXPECT_LT(0.5 * followed.decisions.back().increment, options.smallest_step);
      const Trial& last = followed.result.last_attempt.state;
      EXPECT_GT(strip.assembler.growth(last.at()).breaking, limit);
    }
  }
}

TEST(LoadStepping, HoldsRemovesOrStopsAtFragments) {
  // Only x is held on the right: once the strip is pulled in two, that half is free along y.
  for (const FragmentRemedy remedy :
       {FragmentRemedy::hold, FragmentRemedy::remove, FragmentRemedy::stop}) {
    SCOPED_TRACE(int(remedy));
    Strip strip(Strip::Middle::weak, {support("left", "0", "0"), support("right", "0.1*load")});
    LoadSteppingOptions options = in_mode(Mode::adaptive, 10, 20);
    options.fragments = remedy;
    const Followed followed = follow(strip, options);
    expect_consistent(followed);
    expect_no_healing(followed);
    const bool stops = remedy == FragmentRemedy::stop;
    EXPECT_EQ(followed.result.outcome, stops ? Outcome::fragmented : Outcome::converged);
    EXPECT_GT(followed.steps.back().broken_bonds, 0);
    ASSERT_FALSE(followed.pieces.back().empty());
    for (Index i = 0; i < strip.body.points.count(); ++i) {
      EXPECT_EQ(followed.pieces.back()[std::size_t(i)], strip.body.points.position(i)[0] > 0.7);
    }
    EXPECT_EQ(count_of(followed, Decision::hold_fragments), remedy == FragmentRemedy::hold ? 1 : 0);
    EXPECT_EQ(count_of(followed, Decision::remove_fragments),
              remedy == FragmentRemedy::remove ? 1 : 0);
    EXPECT_EQ(count_of(followed, Decision::stop), stops ? 1 : 0);
    if (stops) {
      EXPECT_LT(followed.steps.back().load_factor, 1.0);
      EXPECT_EQ(followed.decisions.back().outcome, "fragmented");
    } else {
      EXPECT_EQ(followed.steps.back().load_factor, 1.0);
    }
  }
}

}  // namespace
}  // namespace peristat
