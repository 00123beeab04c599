#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "solvers/body/body.hpp"
#include "solvers/drivers/load_stepping.hpp"
#include "solvers/motion/motion_setting.hpp"
#include "solvers/study/linear_systems.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// A model's equations with their solver; owns what a SolvedBody refers to.
class SolvedModel {
 public:
  /// All references must outlive it.
  SolvedModel(const Points& points, const Model& model, const Constraints& constraints,
              const FreeDofs& free, LinearSystems systems, int threads,
              const IndexMap& index_map = whole_body());

  /// Prepares the solver.
  [[nodiscard]] LinearOutcome analyze();

  /// For a driver; call after `analyze`.
  [[nodiscard]] SolvedBody solved() { return {assembler_, solver(), *tangent_, free_}; }

  [[nodiscard]] Assembler& assembler() { return assembler_; }
  [[nodiscard]] LinearSolver& solver() { return *systems_.chosen.solver; }
  [[nodiscard]] const LinearSystems& systems() const { return systems_; }

 private:
  LinearSystems systems_;
  const FreeDofs& free_;
  Assembler assembler_;
  std::unique_ptr<TangentOperator> tangent_;
};

/// @throws InputError for options that can't be used, alone or with this body, a body that the
///         supports do not hold, loose points, and a body that is unstable at rest
void check_study(const Body& body, const StudyOptions& options);

/// A body that has been checked, with everything that follows it along its load path.
class Study {
 public:
  /// The body must outlive the study.
  /// @param tell receives every change to another linear solver; may be empty
  /// @throws InputError as `check_study` does
  /// @throws MemoryError if it would not fit
  Study(const Body& body, StudyOptions options, SolverLadder::Reporter tell = {});

  /// Follows the loading programme; once. A lack of memory is outcome out_of_memory.
  /// @param from a state that `reached` has received, to go on from; null: from rest
  [[nodiscard]] LoadSteppingResult follow(const LoadSteppingObserver& observer,
                                          const SolvedBody* stand_in = nullptr,
                                          const PathState* from = nullptr);

  /// Prepares the solver; `follow` does so if it has not been done.
  /// @throws InputError for loads that are to be found and can't be
  LinearOutcome analyze();

  /// Mode dynamics: the stiffness at the start of the motion.
  /// @throws InputError ("dynamics.time_step") for an explicit step above the stable one, and an
  ///         implicit one below a thousandth of that
  const Stiffness& find_initial_stiffness();

  [[nodiscard]] const Body& body() const { return body_; }
  [[nodiscard]] const StudyOptions& options() const { return options_; }
  [[nodiscard]] const FreeDofs& free() const { return free_; }
  [[nodiscard]] SolvedModel& equations() { return *equations_; }

 private:
  const Body& body_;
  StudyOptions options_;
  FreeDofs free_;
  std::optional<MotionSetting> motion_;  // of mode dynamics
  std::unique_ptr<SolvedModel> equations_;
  std::optional<LinearOutcome> analysis_;
};

/// Result of a study.
struct StudyResult {
  Outcome outcome = Outcome::converged;
  State state;                            ///< last accepted: displacement [m], stage, …
  std::vector<StepRecord> steps;          ///< accepted: energies, reactions, damage
  std::vector<DecisionRecord> decisions;  ///< with their reasons
  Attempt last_attempt;                   ///< that failed
};

/// Follows a body along its loading programme; without one, from load factor 0 to 1.
///
/// @param observer receives everything on the way; may interrupt
/// @throws InputError, MemoryError as Study does. Not converging is an outcome.
[[nodiscard]] StudyResult solve(const Body& body, const StudyOptions& options = {},
                                const LoadSteppingObserver& observer = {});

/// Mean displacement of a set [m], zero beyond the dimension.
/// @throws InputError ("set") if there is no such set
[[nodiscard]] Coordinates mean_displacement(const Points& points, const State& state,
                                            const std::string& set);

}  // namespace peristat
