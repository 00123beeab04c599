#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace peristat {

/// Value at a place of rows { place, value } with ascending places: linear between them, outside
/// that of the nearer end.
[[nodiscard]] double interpolated(std::span<const std::array<double, 2>> rows, double place);

/// A function of one variable, linear between given places: two columns of a text file.
///
/// The first column has the abscissae, strictly ascending. The first line that is neither empty nor
/// a comment (#) may name the columns; it has no number then. Separator is the comma if that line
/// has one, otherwise blanks. Decimals have a point, whatever the locale.
class LinearTable {
 public:
  /// @param column name of the column with the values; empty: the second of two
  /// @throws InputError with "FILE:LINE" as its place for a value that is not a number or not
  ///         finite, other numbers of values than columns, abscissae that do not ascend, and an
  ///         unknown column; with "file" for a file that can't be read or has fewer than two rows
  LinearTable(const std::filesystem::path& file, const std::string& column);

  [[nodiscard]] double first() const { return rows_.front()[0]; }
  [[nodiscard]] double last() const { return rows_.back()[0]; }
  /// True if a place is in the table, up to round-off of its range.
  [[nodiscard]] bool covers(double place) const;
  /// Value at a place; outside that of the nearer end, and not a number at one that is none.
  [[nodiscard]] double operator()(double place) const;

 private:
  std::vector<std::array<double, 2>> rows_;
};

}  // namespace peristat
