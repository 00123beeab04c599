#include "solvers/drivers/path_state.hpp"

#include <algorithm>
#include <any>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cases/runner/results/tables/record_tables.hpp"
#include "solvers/drivers/drivers.hpp"
#include "solvers/drivers/load_stepping.hpp"
#include "solvers/drivers/state_archive.hpp"
#include "solvers/linear/ldlt.hpp"
#include "solvers/linear/solver_ladder.hpp"
#include "tests/softening_strip.hpp"

namespace peristat {
namespace {

using tests::drawn;
using tests::Strip;
using tests::support;

/// Out of memory from the third system on.
class ShortOfMemory : public Cholesky {
 public:
  LinearOutcome factorize(const TangentOperator& tangent, FactorUse use) override {
    return ++systems_ > 2 ? LinearOutcome::out_of_memory : Cholesky::factorize(tangent, use);
  }

 private:
  int systems_ = 0;
};

/// Notes whether the first system of every step may reuse a factor of the step before.
class Observed : public Cholesky {
 public:
  explicit Observed(std::vector<FactorUse>& uses) : uses_(uses) {}

  LinearOutcome factorize(const TangentOperator& tangent, FactorUse use) override {
    uses_.push_back(use);
    return Cholesky::factorize(tangent, use);
  }

 private:
  std::vector<FactorUse>& uses_;
};

/// What a path is followed with. All else is made anew for every path.
struct Setting {
  std::vector<SupportSpecification> supports;
  LoadSteppingOptions options;
  Strip::Middle middle = Strip::Middle::notched;
  double triangles = 0.0;
  bool has_stand_in = false, falls = false;
  int interrupt_after = -1;  ///< accepted steps
  NewtonOptions newton_options{};
  tests::Control control{};
  bool moves = false;  ///< with masses, and a velocity at the start
};

/// A path that has been followed to its end: states and rows that were told.
struct Followed {
  std::vector<PathState> states;  ///< after every step and decision
  std::vector<std::size_t> rows_before, told_before;
  std::vector<Row> rows;
  std::vector<std::vector<double>> told;  ///< displacements and pieces of accepted states
  Outcome outcome = Outcome::converged;
};

/// A body and a solver of its own.
struct Solved {
  Strip strip;
  SolverLadder solver;

  Solved(const Setting& setting, Followed& followed)
      : strip(setting.middle, setting.supports, 1, setting.triangles, setting.control,
              setting.options.mode == Mode::path),
        solver({{"first",
                 [&setting]() -> std::unique_ptr<LinearSolver> {
                   const bool finds_loads =
                       !setting.control.terms.empty() || setting.options.mode == Mode::arc_length;
                   if (finds_loads) return std::make_unique<Ldlt>();
                   if (setting.falls) return std::make_unique<ShortOfMemory>();
                   return std::make_unique<Cholesky>();
                 }},
                {"second", [] { return std::make_unique<Cholesky>(); }}},
               [&followed](const std::string& fall) { followed.rows.push_back({fall}); }) {}

  [[nodiscard]] SolvedBody body() { return {strip.assembler, solver, strip.tangent, strip.free}; }
};

/// Elastic, with a longer horizon.
struct StandIn {
  tests::BoxSetting box = setting();
  tests::BoxBody body{tests::points_with_ends(box), box};
  Assembler assembler{body.points, body.model, 1};
  Tangent tangent{BlockPattern(body.model.bonds()), 2};
  Cholesky solver;

  static tests::BoxSetting setting() {
    tests::BoxSetting box = Strip::setting(0.0);
    box.potential = {};
    box.horizon_ratio = 3.015;
    return box;
  }
};

MotionSetting motion_of(const Strip& strip) {
  MotionSetting motion;
  const std::size_t dofs = strip.body.points.reference.size();
  for (std::size_t k = 0; k < dofs; ++k) {
    motion.mass.push_back(2.0 * strip.body.points.volume[k / 2]);
    motion.displacement.push_back(1e-4 * std::sin(double(k)));
    motion.velocity.push_back(1e-3 * std::cos(double(k)));
  }
  motion.most_points = 3;
  return motion;
}

/// @param from state to go on from; null: from rest
Followed follow(const Setting& setting, const PathState* from = nullptr) {
  Followed followed;
  Solved solved(setting, followed);
  StandIn standing;
  const SolvedBody stand_in{standing.assembler, standing.solver, standing.tangent,
                            solved.strip.free};
  EXPECT_EQ(solved.strip.analyze(solved.solver), LinearOutcome::solved);
  EXPECT_EQ(standing.solver.analyze(standing.tangent.pattern, solved.strip.free),
            LinearOutcome::solved);
  int step = from ? from->steps : 0;
  LoadSteppingObserver observer;
  observer.iteration = [&](const IterationRecord& row) { followed.rows.push_back(make_row(row)); };
  observer.decision = [&](const DecisionRecord& row) { followed.rows.push_back(make_row(row)); };
  observer.accepted = [&](const StepRecord& row, const AcceptedState& state) {
    step = row.step;
    followed.rows.push_back(make_row(row, {"left", "right"}, {}));
    std::vector<double> told = state.trial.displacement;
    told.insert(told.end(), state.piece.begin(), state.piece.end());
    told.insert(told.end(), state.velocity.begin(), state.velocity.end());
    followed.told.push_back(std::move(told));
  };
  observer.interrupted = [&] { return step == setting.interrupt_after; };
  const MotionSetting motion = motion_of(solved.strip);
  const PathSetting all{solved.body(),   solved.strip.conditions,
                        setting.options, setting.newton_options,
                        observer,        setting.has_stand_in ? &stand_in : nullptr,
                        &motion};
  Path path = from ? Path(all, *from) : Path(all);
  if (from) {
    EXPECT_EQ(path.prepare_solvers(), LinearOutcome::solved);
  }
  const std::unique_ptr<Driver> driver = make_driver(setting.options.mode, path);
  do {
    followed.states.push_back(path.state());
    followed.rows_before.push_back(followed.rows.size());
    followed.told_before.push_back(followed.told.size());
  } while (driver->advance() == Advance::goes_on);
  followed.outcome = path.outcome();
  return followed;
}

/// Keeps what it is given, or gives it back.
class Memory : public StateArchive {
 public:
  void give_back() { gives_ = true; }

  void transfer(const std::string& name, bool& value) override { keep(name, value); }
  void transfer(const std::string& name, int& value) override { keep(name, value); }
  void transfer(const std::string& name, std::int64_t& value) override { keep(name, value); }
  void transfer(const std::string& name, double& value) override { keep(name, value); }
  void transfer(const std::string& name, std::vector<char>& values, Rows) override {
    keep(name, values);
  }
  void transfer(const std::string& name, std::vector<Index>& values, Rows) override {
    keep(name, values);
  }
  void transfer(const std::string& name, std::vector<double>& values, Rows) override {
    keep(name, values);
  }

 private:
  template <class Value>
  void keep(const std::string& name, Value& value) {
    if (gives_) {
      value = std::any_cast<Value>(values_.at(name));
    } else {
      EXPECT_TRUE(values_.emplace(name, value).second) << name;
    }
  }

  bool gives_ = false;
  std::map<std::string, std::any> values_;
};

/// A copy by way of an archive.
PathState written_and_read(PathState state) {
  Memory memory;
  transfer(memory, state);
  memory.give_back();
  PathState read;
  transfer(memory, read);
  return read;
}

/// From copies of its first states and some ten others, other paths go on as this one did, to the
/// last bit.
/// @return the path
Followed expect_to_go_on_from_copies(const Setting& setting) {
  const Followed whole = follow(setting);
  const std::size_t count = whole.states.size();
  EXPECT_GT(count, 3u);
  EXPECT_GT(whole.told.size(), 1u);
  for (std::size_t k = 1; k < count; k += k < 3 ? 1 : 1 + count / 10) {
    SCOPED_TRACE(k);
    const PathState copy = written_and_read(whole.states[k]);
    const Followed rest = follow(setting, &copy);
    EXPECT_EQ(rest.outcome, whole.outcome);
    const auto begin = whole.rows.begin() + std::ptrdiff_t(whole.rows_before[k]);
    EXPECT_TRUE(std::equal(rest.rows.begin(), rest.rows.end(), begin, whole.rows.end()));
    const auto told = whole.told.begin() + std::ptrdiff_t(whole.told_before[k]);
    EXPECT_TRUE(std::equal(rest.told.begin(), rest.told.end(), told, whole.told.end()));
  }
  return whole;
}

bool any_state(const Followed& followed, const std::function<bool(const PathState&)>& is_so) {
  return std::any_of(followed.states.begin(), followed.states.end(), is_so);
}

LoadSteppingOptions options_of(Mode mode, int implicit_steps, int relaxation_steps) {
  LoadSteppingOptions options;
  options.mode = mode;
  options.steps = implicit_steps;
  options.relaxation_steps = relaxation_steps;
  return options;
}

TEST(PathState, GoesOnInImplicitSteps) {
  // Triangles release energy as their bonds soften; the weak middle tears at a limit point.
  Setting setting{drawn("0.03*load"), options_of(Mode::newton, 8, 1)};
  setting.middle = Strip::Middle::weak;
  setting.triangles = 0.2;
  setting.options.smallest_step = 1e-2;
  const Followed whole = expect_to_go_on_from_copies(setting);
  EXPECT_EQ(whole.outcome, Outcome::limit_point);
  EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.ledger.released != 0.0; }));
  EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.implicit.increment > 0.0; }));
}

TEST(PathState, GoesOnInRelaxedSteps) {
  // Too few iterations for the first step, which is cut.
  Setting setting{drawn("0.03*load"), options_of(Mode::relaxation, 1, 2)};
  setting.options.relaxation.relative_tolerance = 1e-6;
  setting.options.relaxation.max_iterations = 150;
  setting.interrupt_after = 5;
  const Followed whole = expect_to_go_on_from_copies(setting);
  EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.relaxed.increment > 0.0; }));
}

TEST(PathState, GoesOnInTheMidstOfMotion) {
  Setting setting{drawn("0.03*load"), options_of(Mode::relaxation, 1, 10)};
  setting.options.relaxation.holds = false;
  setting.options.relaxation.breaking = Breaking::transient;
  const Followed whole = expect_to_go_on_from_copies(setting);
  EXPECT_TRUE(
      any_state(whole, [](const PathState& s) { return !s.relaxed.motion.velocity.empty(); }));
}

TEST(PathState, GoesOnInStepsWithoutInertia) {
  for (const Breaking breaking : {Breaking::at_equilibrium, Breaking::transient}) {
    Setting setting{drawn("0.03*load"), options_of(Mode::relaxation, 1, 10)};
    setting.options.relaxation.method = RelaxationMethod::flow;
    setting.options.relaxation.breaking = breaking;
    const Followed whole = expect_to_go_on_from_copies(setting);
    EXPECT_EQ(whole.outcome, Outcome::converged);
  }
}

TEST(PathState, GoesOnWhileAPeakIsSearched) {
  Setting setting{drawn("0.045*load"), options_of(Mode::adaptive, 10, 20)};
  setting.options.relaxation.method = RelaxationMethod::flow;
  setting.options.peak_tolerance = 1e-3;
  const Followed whole = expect_to_go_on_from_copies(setting);
  EXPECT_EQ(whole.outcome, Outcome::converged);
  EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.hand_over.peak_before > 0.0; }));
  EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.hand_over.force_falls; }));
  EXPECT_EQ(whole.states.back().hand_over.peak_before, 0.0);
}

TEST(PathState, GoesOnFromEventToEvent) {
  // Triangles lose with their bonds; the halves come apart, one of them free along y.
  for (const double triangles : {0.0, 0.2}) {
    Setting setting{{support("left", "0", "0"), support("right", "0.1*load")},
                    options_of(Mode::path, 4, 1)};
    setting.middle = Strip::Middle::weak;
    setting.triangles = triangles;
    const Followed whole = expect_to_go_on_from_copies(setting);
    EXPECT_EQ(whole.outcome, Outcome::converged);
    EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.events.at_strength; }));
    EXPECT_TRUE(any_state(whole, [](const PathState& s) {
      return s.accepted.stage < s.events.top && !s.events.tangent.lost.empty();
    }));
    EXPECT_GT(whole.states.back().events.released, 0.0);
    EXPECT_FALSE(whole.states.back().pins.pinned.empty());
  }
}

TEST(PathState, GoesOnBeforeAndAfterAHandOver) {
  // Pulled and then let go.
  const Setting setting{drawn("0.045*min(load, 1.2 - load)"), options_of(Mode::adaptive, 10, 50)};
  const Followed whole = expect_to_go_on_from_copies(setting);
  EXPECT_EQ(whole.outcome, Outcome::converged);
  EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.hand_over.relaxes; }));
  EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.hand_over.is_near_onset; }));
  EXPECT_FALSE(whole.states.back().hand_over.relaxes);
}

TEST(PathState, GoesOnNearTheOnsetOfDamage) {
  // What is left before the onset is more than a relaxed step, and would be cut to once more.
  Setting setting{drawn("0.02*load"), options_of(Mode::adaptive, 1, 500)};
  setting.interrupt_after = 4;
  const Followed whole = expect_to_go_on_from_copies(setting);
  EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.hand_over.is_near_onset; }));
}

TEST(PathState, GoesOnWithFragmentsPinned) {
  // Only x is held on the right: once the strip is pulled in two, that half is free along y.
  for (const FragmentRemedy remedy : {FragmentRemedy::hold, FragmentRemedy::remove}) {
    Setting setting{{support("left", "0", "0"), support("right", "0.1*load")},
                    options_of(Mode::adaptive, 10, 20)};
    setting.middle = Strip::Middle::weak;
    setting.options.fragments = remedy;
    const Followed whole = expect_to_go_on_from_copies(setting);
    EXPECT_EQ(whole.outcome, Outcome::converged);
    EXPECT_FALSE(whole.states.back().pins.pinned.empty());
  }
}

TEST(PathState, GoesOnWithAStandInAndWithoutIt) {
  Setting setting{drawn("0.03*load"), options_of(Mode::adaptive, 10, 20)};
  setting.has_stand_in = true;
  const Followed whole = expect_to_go_on_from_copies(setting);
  EXPECT_EQ(whole.outcome, Outcome::converged);
  EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.stands_in && s.steps > 0; }));
  EXPECT_FALSE(whole.states.back().stands_in);
}

TEST(PathState, GoesOnOnTheRungOfItsSolver) {
  Setting setting{drawn("0.005*load"), options_of(Mode::newton, 4, 1)};
  setting.falls = true;
  const Followed whole = expect_to_go_on_from_copies(setting);
  EXPECT_EQ(whole.outcome, Outcome::converged);
  EXPECT_EQ(whole.states.front().rungs.body, 0);
  EXPECT_EQ(whole.states.back().rungs.body, 1);
}

TEST(PathState, GoesOnUnderAControl) {
  Setting setting{drawn("0.05*load"), options_of(Mode::newton, 10, 1)};
  setting.control = tests::mouth_opening(0.015);
  const Followed whole = expect_to_go_on_from_copies(setting);
  EXPECT_EQ(whole.outcome, Outcome::converged);
  EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.accepted.load.has_value(); }));
  // The load falls as bonds break at an opening that stands still.
  EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.ledger.entries.drained > 0.0; }));
  const auto falls = [](const PathState& before, const PathState& after) {
    return before.steps > 0 && *after.accepted.load < *before.accepted.load;
  };
  EXPECT_NE(std::adjacent_find(whole.states.begin(), whole.states.end(), falls),
            whole.states.end());
}

TEST(PathState, GoesOnAlongTheArcLength) {
  // Pushed together until it buckles.
  Setting setting{{support("left", "0", "0"), support("right", "-0.5*load")},
                  options_of(Mode::arc_length, 40, 1)};
  setting.middle = Strip::Middle::elastic;
  setting.options.arc_length.steps = 30;
  setting.options.arc_length.largest_step = 0.05;
  const Followed whole = expect_to_go_on_from_copies(setting);
  EXPECT_EQ(whole.outcome, Outcome::converged);
  EXPECT_TRUE(any_state(whole, [](const PathState& s) { return s.arc.passes_critical_point; }));
}

TEST(PathState, GoesOnInTime) {
  for (const double triangles : {0.0, 0.2}) {
    for (const double time_step : {0.0, 0.01}) {
      Setting setting{drawn("0.06*t"), options_of(Mode::dynamics, 1, 1)};
      setting.control.programme = LoadingProgramme::of_time(1.0);
      setting.triangles = triangles;
      setting.options.dynamics = {time_step, 0.5, 7};
      const Followed whole = expect_to_go_on_from_copies(setting);
      EXPECT_EQ(whole.outcome, Outcome::converged);
      const PathState& last = whole.states.back();
      EXPECT_EQ(last.accepted.stage, 1.0);
      EXPECT_GT(last.ledger.entries.dissipated, 0.0);
      EXPECT_GT(last.ledger.entries.kinetic, 0.0);
      EXPECT_EQ(last.dynamics.velocity.size(), last.accepted.displacement.size());
    }
  }
}

TEST(PathState, IsToldWhereAPathCanGoOn) {
  const Setting setting{drawn("0.045*min(load, 1.2 - load)"), options_of(Mode::adaptive, 10, 50)};
  Followed followed;
  std::vector<PathState> reached;
  const auto follow_from = [&](const PathState* from) {
    Solved solved(setting, followed);
    EXPECT_EQ(solved.strip.analyze(solved.solver), LinearOutcome::solved);
    LoadSteppingObserver observer;
    if (from == nullptr)
      observer.reached = [&](const PathState& state) { reached.push_back(state); };
    return follow_loading(
        {solved.body(), solved.strip.conditions, setting.options, setting.newton_options, observer},
        from);
  };
  const LoadSteppingResult whole = follow_from(nullptr);
  ASSERT_EQ(whole.outcome, Outcome::converged);
  ASSERT_EQ(int(reached.size()), 1 + whole.steps);
  for (std::size_t k = 0; k < reached.size(); k += 5) {
    SCOPED_TRACE(k);
    EXPECT_EQ(reached[k].steps, int(k));
    const LoadSteppingResult rest = follow_from(&reached[k]);
    EXPECT_EQ(rest.outcome, whole.outcome);
    EXPECT_EQ(rest.steps, whole.steps);
    EXPECT_EQ(rest.state.displacement, whole.state.displacement);
  }
}

TEST(PathState, KeepsNoFactorForTheNextStep) {
  for (const Mode& mode : {Mode::newton, Mode::adaptive}) {
    SCOPED_TRACE(mode.name);
    const Setting setting{drawn("0.03*load"), options_of(mode, 10, 20)};
    Followed followed;
    std::vector<FactorUse> uses;
    Solved solved(setting, followed);
    Observed solver(uses);
    EXPECT_EQ(solved.strip.analyze(solver), LinearOutcome::solved);
    std::vector<std::size_t> first_of_step{0};
    LoadSteppingObserver observer;
    observer.accepted = [&](const StepRecord& row, const AcceptedState&) {
      if (row.step > 0) first_of_step.push_back(uses.size());
    };
    const LoadSteppingResult result =
        follow_loading({{solved.strip.assembler, solver, solved.strip.tangent, solved.strip.free},
                        solved.strip.conditions,
                        setting.options,
                        setting.newton_options,
                        observer});
    EXPECT_GT(result.steps, 5);
    first_of_step.pop_back();
    for (const std::size_t first : first_of_step) {
      if (first == uses.size()) break;
      EXPECT_EQ(uses[first], FactorUse::factorize_now) << first;
    }
    EXPECT_NE(std::count(uses.begin(), uses.end(), FactorUse::may_reuse), 0);
  }
}

TEST(Drivers, EachModeHasOne) {
  Followed followed;
  const Setting setting{drawn("0.005*load"), {}};
  Solved solved(setting, followed);
  const LoadSteppingObserver observer;
  Path path(
      {solved.body(), solved.strip.conditions, setting.options, setting.newton_options, observer});
  for (const Mode& mode : {Mode::newton, Mode::relaxation, Mode::adaptive, Mode::arc_length}) {
    EXPECT_TRUE(make_driver(mode, path));
  }
  EXPECT_GE(all_drivers().size(), 4u);
  EXPECT_THROW((void)make_driver(Mode{"none"}, path), std::logic_error);
}

}  // namespace
}  // namespace peristat
