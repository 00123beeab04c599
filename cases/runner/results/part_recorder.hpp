#pragma once

#include <optional>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/process/progress.hpp"
#include "cases/runner/results/point_rows.hpp"
#include "cases/runner/results/results.hpp"
#include "cases/runner/results/step_part.hpp"
#include "solvers/drivers/observer.hpp"
#include "solvers/study/body.hpp"
#include "solvers/study/motion.hpp"

namespace peristat {

/// As Recorder, of a body that ranks have parts of: rank 0 writes what all have. Its calls are ones
/// that all ranks make.
class PartRecorder {
 public:
  /// @param results null on all ranks but 0
  PartRecorder(const Case& from, const Body& body, Assembler& assembler,
               const RowGathering& gathering, Results* results, Progress& progress)
      : case_(from),
        body_(body),
        assembler_(assembler),
        gathering_(gathering),
        results_(results),
        progress_(progress) {
    if (from.dynamics.is_asked_for) density_ = densities_of(body);
  }

  void iteration(const IterationRecord& record);
  void decided(const DecisionRecord& record);
  void accepted(StepRecord record, const AcceptedState& state);

  /// Writes the fields of the last accepted state, whatever output.every says.
  void finish();

  [[nodiscard]] const std::optional<StepRecord>& last() const { return last_; }

 private:
  /// Of the points that this rank owns.
  struct Fields {
    std::vector<double> displacement, force, damage, energy_density, stretch, fragment;
    std::vector<double> velocity, kinetic_energy_density;
    bool is_motion = false;
    [[nodiscard]] StepFields view() const;
  };
  [[nodiscard]] Fields fields(const StateView& at, std::vector<double> force) const;
  [[nodiscard]] double find_stretches(const StateView& at, std::vector<double>& stretch) const;
  void add_motion(std::span<const double> velocity, Fields& made) const;
  void send(const Fields& fields) const;

  const Case& case_;
  const Body& body_;
  Assembler& assembler_;
  const RowGathering& gathering_;
  Results* const results_;
  Progress& progress_;
  std::vector<double> density_;  // of a motion
  double relative_residual_ = 0.0;
  std::optional<StepRecord> last_;
  std::optional<Fields> unwritten_;  // of the last step
};

}  // namespace peristat
