#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/process/progress.hpp"
#include "cases/runner/results/points_part.hpp"
#include "cases/runner/results/run_costs.hpp"
#include "solvers/study/study.hpp"

namespace peristat {

/// What runs tell of themselves, on one rank or more.

/// Writes the folder to the pipe, or new file, that the environment variable PERISTAT_NOTE names,
/// if it does.
void leave_note(const std::filesystem::path& directory);

/// Refuses a run whose results would take the place of what it reads, and a log that would stand in
/// the results folder or in the place of an input.
/// @throws InputError before anything is written
void keep_inputs_and_log_apart(const Case& from, const std::string& log_file);

/// The file as every way to it names it, so that a later run knows it again.
[[nodiscard]] std::filesystem::path identity(const std::filesystem::path& case_file);

/// Whose reactions are told.
[[nodiscard]] std::vector<std::string> support_sets(const Case& from);

/// What the results folder tells of every point that is this body's own: the counts of [CPD] sec.
/// 3.1, its region and random factors, and its row in a file of points.
[[nodiscard]] std::vector<PointCounts> constant_fields_of(const Case& from, const Body& body);

/// Of the points that are this body's own [m].
[[nodiscard]] double largest_displacement(const std::vector<double>& displacement,
                                          const Points& points);

/// Adds what assembly and linear solver have cost.
void add_costs(SolvedModel& solved, RunCosts& costs);

/// Up to where a run that did not end well has come: "after load factor 0.5".
/// @param moves whether it is a motion, which has a time in place of a load factor
/// @param last  of the accepted steps
[[nodiscard]] std::string place_of_failure(const LoadSteppingResult& result, double load_factor,
                                           bool moves, const std::optional<StepRecord>& last);

/// @param where by place_of_failure
[[nodiscard]] std::string failure_reason(const LoadSteppingResult& result, const std::string& where,
                                         const std::vector<DecisionRecord>& decisions);

[[nodiscard]] std::string status_of(Outcome outcome);

/// What the last step has come to.
void report_result(const std::optional<StepRecord>& of_last, Progress& progress);

}  // namespace peristat
