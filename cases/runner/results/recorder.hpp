#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/process/progress.hpp"
#include "cases/runner/results/crack_measures.hpp"
#include "cases/runner/results/damage_histories.hpp"
#include "cases/runner/results/line_probe.hpp"
#include "cases/runner/results/probe.hpp"
#include "cases/runner/results/results.hpp"
#include "cases/runner/results/stress_fields.hpp"
#include "cases/runner/setup/body.hpp"
#include "cases/runner/setup/recorded_points.hpp"
#include "solvers/drivers/load_stepping.hpp"
#include "solvers/study/crack_tips.hpp"
#include "solvers/study/motion.hpp"

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
        own_(std::size_t(recorded_.count())),
        assembler_(assembler),
        results_(results),
        progress_(progress),
        body_(body),
        crack_tips_(crack_tips) {
    for (const BondEnds& ends : body.cut_bonds) {
      if (recorded_.tells(ends[0], ends[1])) separated_.push_back(ends);
    }
    cut_ = separated_.size();
    if (from.dynamics.is_asked_for) density_ = densities_of(body);
    for (const ProbeSpecification& probe : from.probes) {
      if (probe.from) lines_.emplace_back(probe, recorded_);
    }
  }

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

 private:
  struct Fields {
    std::vector<double> displacement, force, damage, energy_density, stretch, fragment;
    std::optional<std::vector<double>> velocity;  ///< of a body in motion
    std::vector<double> kinetic_energy_density;
    double max_damage = 0.0, max_stretch = 0.0;
    std::optional<BondHistories> histories;
    std::optional<StressFields> stress;  ///< where a probe or the results need it
    /// @param with_stress include strain and stress
    [[nodiscard]] StepFields view(bool with_stress) const;
  };

  /// Fields of a state.
  /// @param force minus its gradient [N]; may have more points than these
  [[nodiscard]] Fields fields(const StateView& at, std::vector<double> force,
                              std::span<const std::int32_t> piece,
                              std::span<const double> velocity) const;
  /// Adds velocity and kinetic energy.
  void add_motion(std::span<const double> velocity, Fields& made) const;
  /// Bonds that have broken since the last call.
  [[nodiscard]] std::vector<BondEnds> newly_broken(const History& history);
  /// Adds the bonds that have broken since the last step to the results.
  void record_broken_bonds(const StepRecord& record, const History& history);
  /// True if any point has moved, on any rank.
  [[nodiscard]] bool moves(std::span<const double> displacement) const;
  /// State of the cracks for a probe.
  [[nodiscard]] CrackState crack_state(const StepRecord& record, const std::string& probe) const;
  /// Updates growth_ by an accepted step.
  void note_growth(const StepRecord& record);
  /// Restores growth_ from earlier steps.
  void find_growth(const EarlierResults& earlier, const std::vector<std::string>& support_sets,
                   const std::vector<ProbeColumns>& probes);

  const Case& case_;
  const Points& points_;
  const RecordedPoints recorded_;
  std::size_t own_;  // number of recorded points
  Assembler& assembler_;
  Results& results_;
  Progress& progress_;
  const Body& body_;
  const std::vector<CrackTip>& crack_tips_;
  std::optional<Fields> unwritten_;    // of the last step, if it only entered the history
  std::vector<char> broken_;           // per bond, in the last accepted state
  DamageHistories written_histories_;  // in the last state that was written with fields
  std::vector<double> density_;        // per point, of a body in motion [kg/m3]
  std::vector<LineProbe> lines_;
  /// Bonds cut by pre-cracks, or broken up to the last accepted state, that this rank reports.
  std::vector<BondEnds> separated_;
  std::size_t cut_ = 0;                        // number of these cut by pre-cracks
  std::map<std::string, CrackGrowth> growth_;  // per probe of crack_resistance
  double relative_residual_ = 0.0;
  std::optional<StepRecord> last_;
  std::vector<DecisionRecord> decisions_;
};

}  // namespace peristat
