#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace peristat {

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

  [[nodiscard]] double first() const { return at_.front(); }
  [[nodiscard]] double last() const { return at_.back(); }
  /// True if a place is in the table, up to round-off of its range.
  [[nodiscard]] bool covers(double place) const;
  /// Value at a place; outside that of the nearer end, and not a number at one that is none.
  [[nodiscard]] double operator()(double place) const;

 private:
  std::vector<double> at_, value_;
};

}  // namespace peristat
