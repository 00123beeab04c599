#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/process/progress.hpp"
#include "cases/runner/results/damage_histories.hpp"
#include "cases/runner/results/point_rows.hpp"
#include "cases/runner/results/results.hpp"
#include "cases/runner/results/step_part.hpp"
#include "solvers/drivers/observer.hpp"
#include "solvers/study/body.hpp"

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
        progress_(progress),
        whole_number_(whole_numbers(*body.part, body.points.volume.size(), body.points.dimension)) {
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
    double max_damage = 0.0;                   // of all ranks
    std::optional<BondHistories> histories{};  // at rank 0, of all ranks
    [[nodiscard]] StepFields view() const;
  };
  [[nodiscard]] Fields fields(const StateView& at, std::vector<double> force,
                              std::span<const std::int32_t> piece) const;
  struct ToldBond {
    BondEnds ends{};
    double stretch = 0.0;
  };
  /// At rank 0: bonds that ranks tell, each once, by their numbers in the whole body; ascending.
  [[nodiscard]] std::vector<ToldBond> of_all(const std::vector<ToldBond>& mine) const;
  [[nodiscard]] std::optional<BondHistories> histories_of_all(const BondHistories& mine) const;
  void record_broken_bonds(const StepRecord& record, const History& history);
  [[nodiscard]] double find_stretches(const StateView& at, std::vector<double>& stretch) const;
  void send(const Fields& fields) const;

  const Case& case_;
  const Body& body_;
  Assembler& assembler_;
  const RowGathering& gathering_;
  Results* const results_;
  Progress& progress_;
  const std::vector<double> whole_number_;  // of each point here
  DamageHistories written_histories_;
  std::vector<char> broken_;  // bonds that have been told
  double relative_residual_ = 0.0;
  std::optional<StepRecord> last_;
  std::optional<Fields> unwritten_;  // of the last step
};

}  // namespace peristat
