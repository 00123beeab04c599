#pragma once

#include <string>
#include <vector>

#include "cases/runner/results/files/table.hpp"
#include "cases/runner/results/tables/probe_columns.hpp"
#include "solvers/problem/records.hpp"

namespace peristat {

[[nodiscard]] std::vector<Column> iteration_columns();
[[nodiscard]] std::vector<Column> decision_columns();
[[nodiscard]] std::vector<Column> broken_bond_columns();

/// The step's own columns, then reaction_x:SET, reaction_y:SET, reaction_z:SET per support set,
/// then the probes: NAME of one component, NAME_x, NAME_y, NAME_z of more.
/// @throws InputError (key "probe") if a probe's column has the name of another column
[[nodiscard]] std::vector<Column> history_columns(const std::vector<std::string>& support_sets,
                                                  const std::vector<ProbeColumns>& probes);

/// Rows for the columns above. A record that holds a number that is not finite, or not exactly the
/// announced support sets and probes, is a bug of the caller:
/// @throws std::logic_error that names the column
[[nodiscard]] Row make_row(const IterationRecord& record);
[[nodiscard]] Row make_row(const DecisionRecord& record);
[[nodiscard]] Row make_row(const BrokenBondRecord& record);
[[nodiscard]] Row make_row(const StepRecord& record, const std::vector<std::string>& support_sets,
                           const std::vector<ProbeColumns>& probes);

/// Reads the records that rows were made of.
/// @throws std::exception if a row does not have these columns
[[nodiscard]] IterationRecord read_iteration(const Row& row);
[[nodiscard]] DecisionRecord read_decision(const Row& row);
[[nodiscard]] StepRecord read_step(const Row& row, const std::vector<std::string>& support_sets,
                                   const std::vector<ProbeColumns>& probes);

}  // namespace peristat
