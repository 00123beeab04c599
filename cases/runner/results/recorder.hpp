#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/process/progress.hpp"
#include "cases/runner/results/checkpoint/damage_histories.hpp"
#include "cases/runner/results/results.hpp"
#include "cases/runner/results/tables/driven_sets.hpp"
#include "cases/runner/setup/body.hpp"
#include "solvers/drivers/load_stepping.hpp"
#include "solvers/observe/probe.hpp"
#include "solvers/observe/separated_bonds.hpp"
#include "solvers/study/crack_tips.hpp"

namespace peristat {

/// Turns accepted equilibria into rows, fields and probes of the results folder, and prints
/// progress. For a distributed body all calls are collective.
class Recorder {
 public:
  Recorder(const Case& from, const Body& body, Assembler& assembler, Results& results,
           Progress& progress, const std::vector<CrackTip>& crack_tips)
      : case_(from),
        points_(body.points),
        recorded_(body.points, *body.index_map),
        assembler_(assembler),
        results_(results),
        progress_(progress),
        body_(body),
        crack_tips_(crack_tips),
        separated_(body),
        driven_(from, body) {}

  /// Restores its state at the time of the checkpoint.
  void go_on(const Checkpoint& checkpoint, const EarlierResults& earlier,
             const std::vector<std::string>& support_sets, const std::vector<ProbeColumns>& probes);

  void iteration(const IterationRecord& record);
  void accepted(StepRecord record, const AcceptedState& state);
  /// If the load is an unknown, a failed search is recorded at the load of the last accepted state.
  void decided(DecisionRecord record);
  /// A linear solver has given way to the next one.
  void changed_solver(const std::string& reason);

  /// State that the run can be resumed from, without its costs.
  [[nodiscard]] Checkpoint checkpoint(const PathState& path) const;

  /// Writes the fields of the last accepted state, whatever output.every says.
  void finish();

  [[nodiscard]] const std::optional<StepRecord>& last() const { return last_; }
  [[nodiscard]] const std::vector<DecisionRecord>& decisions() const { return decisions_; }
  /// True if an obstacle has pressed on the body in any recorded state.
  [[nodiscard]] bool has_pressed(const std::string& obstacle) const {
    return pressed_.contains(obstacle);
  }

 private:
  /// Fields of a state that are recorded: for steps of the results, and for probes.
  struct Fields : StepFields {
    double max_damage = 0.0, max_stretch = 0.0;
  };
  [[nodiscard]] Fields fields(const StateView& at, ObservedExtras extras) const;
  /// Adds the bonds that have broken since the last step to the results.
  void record_broken_bonds(const StepRecord& record, const History& history);
  /// True if any point has moved, on any rank.
  [[nodiscard]] bool moves(std::span<const double> displacement) const;
  /// State of the cracks for a probe.
  [[nodiscard]] CrackState crack_state(const StepRecord& record, const std::string& probe) const;
  /// Updates pressed_ by an accepted step.
  void note_pressed(const StepRecord& record);
  /// Updates growth_ by an accepted step.
  void note_growth(const StepRecord& record);
  /// Restores growth_ from earlier steps.
  void find_growth(const EarlierResults& earlier, const std::vector<std::string>& support_sets,
                   const std::vector<ProbeColumns>& probes);

  const Case& case_;
  const Points& points_;
  const RecordedPoints recorded_;
  Assembler& assembler_;
  Results& results_;
  Progress& progress_;
  const Body& body_;
  const std::vector<CrackTip>& crack_tips_;
  std::optional<StepFields> unwritten_;  // of the last step, if it only entered the history
  DamageHistories written_histories_;    // in the last state that was written with fields
  SeparatedBonds separated_;
  const DrivenSets driven_;
  std::map<std::string, CrackGrowth> growth_;  // per probe of crack_resistance
  std::set<std::string> pressed_;              // names of obstacles
  double relative_residual_ = 0.0;
  std::optional<StepRecord> last_;
  std::vector<DecisionRecord> decisions_;
};

}  // namespace peristat
