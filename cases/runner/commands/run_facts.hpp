#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/process/progress.hpp"
#include "cases/runner/results/parts/points_part.hpp"
#include "cases/runner/results/tables/run_costs.hpp"
#include "solvers/study/study.hpp"

namespace peristat {

/// Facts about runs, on one rank or more.

/// Writes the folder to the pipe, or new file, that the environment variable PERISTAT_NOTE names,
/// if it is set.
void leave_note(const std::filesystem::path& directory);

/// Refuses a run whose results would overwrite its inputs, and a log that would be in the results
/// folder or overwrite an input.
/// @throws InputError before anything is written
void keep_inputs_and_log_apart(const Case& from, const std::string& log_file);

/// Canonical path of the case file, by which a later run recognises it.
[[nodiscard]] std::filesystem::path identity(const std::filesystem::path& case_file);

/// Checksum and path of each file that the case reads, in a line each.
[[nodiscard]] std::string checksums_of_files(const Case& from);

/// Names of the sets and constraints whose reactions are reported.
[[nodiscard]] std::vector<std::string> support_sets(const Case& from);

/// Constant fields of the body's own points for the results: the counts of [CPD] sec. 3.1, region
/// and random factors, and the row in a file of points.
[[nodiscard]] std::vector<PointCounts> constant_fields_of(const Case& from, const Body& body);

/// Largest displacement of the body's own points [m].
[[nodiscard]] double largest_displacement(const std::vector<double>& displacement,
                                          const Points& points);

/// Adds what assembly and linear solver have cost.
void add_costs(SolvedModel& solved, RunCosts& costs);

/// Position at which a run has failed or was interrupted: "after load factor 0.5".
/// @param moves true for a motion, which has a time in place of a load factor
/// @param last  of the accepted steps
[[nodiscard]] std::string place_of_failure(const LoadSteppingResult& result, double load_factor,
                                           bool moves, const std::optional<StepRecord>& last);

/// @param where from place_of_failure
[[nodiscard]] std::string failure_reason(const LoadSteppingResult& result, const std::string& where,
                                         const std::vector<DecisionRecord>& decisions);

[[nodiscard]] std::string status_of(Outcome outcome);

/// Prints reactions and probes of the last step.
void report_result(const std::optional<StepRecord>& of_last, Progress& progress);

}  // namespace peristat
