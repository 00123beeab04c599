#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/results/files/csv_table.hpp"
#include "cases/runner/results/tables/probe_columns.hpp"
#include "solvers/study/neighbours.hpp"
#include "solvers/study/study.hpp"

namespace peristat {

/// Derivatives of columns of the history with respect to numbers of the case (table [sensitivity]),
/// found along with the run: half the differences of two bodies in which a number is smaller and
/// larger by a few millionths, over its change (Neighbours).
class Sensitivities {
 public:
  /// Makes the neighbouring bodies. The case and the study must outlive it.
  /// @throws InputError ("sensitivity.over[k]") for a key that is no number other than 0, or that
  ///         moves points or changes bonds and supports; ("sensitivity.over") for a body that can't
  ///         be differentiated
  /// @throws MemoryError if a body would not fit
  Sensitivities(const Case& from, Study& study, const std::vector<std::string>& support_sets,
                const std::vector<ProbeColumns>& probes);
  ~Sensitivities();

  static constexpr const char* file_name = "sensitivities.csv";

  /// Creates the table in the results folder.
  void open(const std::filesystem::path& folder);
  /// Follows an equilibrium that is about to be committed.
  void follow(const UncommittedState& state);
  /// Adds the rows of an accepted state.
  /// @return why the derivatives end before this state, once; empty otherwise
  [[nodiscard]] std::string add(const StepRecord& record, const AcceptedState& state);

 private:
  struct Parameter;
  /// Lets all bodies follow; a failure becomes the attempt's fault.
  void move_to(const UncommittedState& state, bool commits);
  [[nodiscard]] StepRecord record_of(const Parameter& parameter, std::size_t side,
                                     const StepRecord& accepted, const AcceptedState& state) const;
  [[nodiscard]] Row derivatives(const Parameter& parameter, const StepRecord& accepted,
                                const AcceptedState& state) const;

  const Case& from_;
  Study& study_;
  const std::vector<std::string> support_sets_;
  const std::vector<ProbeColumns> probes_;
  std::vector<Column> columns_;      // of the table
  std::vector<std::size_t> places_;  // of the differentiated ones in the history
  std::vector<std::unique_ptr<Parameter>> parameters_;
  std::unique_ptr<CsvTable> table_;
  bool has_ended_ = false;
  std::optional<std::uint64_t> version_of_start_;  // of the history before the step
  bool has_followed_ = false;                      // an equilibrium of the step
  std::string fault_;                              // of the present attempt of the step
};

}  // namespace peristat
