#pragma once

#include <string>

#include "cases/runner/input/case_keys.hpp"
#include "cases/runner/process/failure.hpp"

namespace peristat {

/// The keys of a table of the case file as a table in markdown.
[[nodiscard]] std::string key_reference(const TableDescription& table);

/// The command `keys`: prints the reference of a table, or of all.
/// @param table dotted name ("lattice.shape") or "document"; empty for all
/// @throws InputError with a similar name if there is no such table
[[nodiscard]] Exit print_keys(const std::string& table);

/// The command `keys --ranks`: prints the keys that run on several ranks, a row for each table.
[[nodiscard]] Exit print_keys_on_ranks();

}  // namespace peristat
