#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace peristat {

/// The quoted arguments of a call of `table` in an expression: `"file.csv"`, or
/// `"file.csv", "column"`.
struct TableCall {
  std::size_t begin = 0, end = 0;  ///< of the quoted arguments in the text, with their quotes
  std::string file;
  std::string column;  ///< empty: the second of two
};

/// Finds the calls of `table` in the text of an expression. Quotes are " or '.
/// @throws InputError without a key for a call whose first argument is not quoted, for quotes
///         elsewhere, and for those that are not closed
[[nodiscard]] std::vector<TableCall> table_calls(const std::string& text);

/// The text of an expression with other names of its tables' files.
/// @throws InputError as table_calls does, and for a name with both kinds of quotes
[[nodiscard]] std::string with_table_files(
    const std::string& text, const std::function<std::string(const std::string& file)>& rename);

}  // namespace peristat
