#include "src/core/linear_table.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>

#include "src/core/input_error.hpp"
#include "src/core/nearest_name.hpp"
#include "src/core/number_text.hpp"
#include "src/core/table_text.hpp"

namespace peristat {
namespace {

/// Share of a table's range by which a place may lie outside: round-off of a sum of steps.
constexpr double round_off_of_range = 1e-9;

/// Reads two columns of a table, row by row.
class TwoColumns {
 public:
  TwoColumns(const std::filesystem::path& file, const std::string& column)
      : file_(file), column_(column) {}

  /// Returns false for the line that names the columns.
  bool read(std::size_t line, std::string_view text, double& at, double& value) {
    line_ = line;
    const bool is_first = columns_ == 0;
    if (is_first) by_comma_ = text.find(',') != std::string_view::npos;
    const std::vector<std::string_view> cells =
        by_comma_ ? split(text, ',') : split_at_blanks(text);
    // A line with any number is a row, whose other fields must be numbers, too.
    const bool is_header = is_first && std::ranges::none_of(cells, [](std::string_view cell) {
                             std::string why_not;
                             return number_in(cell, why_not).has_value();
                           });
    if (is_first) choose(cells, is_header);
    if (cells.size() != columns_) {
      refuse(std::to_string(cells.size()) + " values for " + std::to_string(columns_) + " columns");
    }
    if (is_header) return false;
    at = number(cells.front());
    value = number(cells[chosen_]);
    return true;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError("", "", what, file_.string() + ":" + std::to_string(line_));
  }

 private:
  void choose(const std::vector<std::string_view>& cells, bool is_header) {
    columns_ = cells.size();
    if (columns_ < 2) refuse("a table needs two columns, separated by commas or blanks");
    if (column_.empty()) {
      if (columns_ == 2) return;
      refuse("the table has " + std::to_string(columns_) +
             " columns: name the one with the values, as in table(\"file.csv\", \"column\", t)");
    }
    if (!is_header) refuse("no line names the columns, so there is no column '" + column_ + "'");
    const std::vector<std::string> names(cells.begin() + 1, cells.end());
    const auto found = std::ranges::find(names, column_);
    if (found == names.end()) {
      std::string all;
      for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
      const std::string nearest = nearest_name(column_, names);
      refuse("no column '" + column_ + "' of values; there are " + all +
             (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
    }
    if (std::ranges::count(names, column_) > 1) refuse("column '" + column_ + "' appears twice");
    chosen_ = std::size_t(found - names.begin()) + 1;
  }

  double number(std::string_view text) const {
    std::string why_not;
    const std::optional<double> value = number_in(text, why_not);
    if (!value) refuse("'" + std::string(text) + "' " + why_not);
    return *value;
  }

  const std::filesystem::path& file_;
  const std::string& column_;
  std::size_t line_ = 0, columns_ = 0, chosen_ = 1;
  bool by_comma_ = false;
};

}  // namespace

LinearTable::LinearTable(const std::filesystem::path& file, const std::string& column) {
  // A device might never end.
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError("file", file.string(), "no such file");
  TwoColumns columns(file, column);
  for_each_row(file, [&](std::size_t line, std::string_view text) {
    double at = 0.0, value = 0.0;
    if (!columns.read(line, text, at, value)) return;
    if (!rows_.empty() && !(at > last())) {
      columns.refuse("the first column must ascend, but " + number_text(at) + " follows " +
                     number_text(last()));
    }
    rows_.push_back({at, value});
  });
  if (rows_.size() < 2) throw InputError("file", file.string(), "a table needs at least two rows");
}

bool LinearTable::covers(double place) const {
  const double slack = round_off_of_range * (last() - first());
  return place >= first() - slack && place <= last() + slack;
}

double LinearTable::operator()(double place) const {
  return std::isnan(place) ? place : interpolated(rows_, place);
}

double interpolated(std::span<const std::array<double, 2>> rows, double place) {
  if (place <= rows.front()[0]) return rows.front()[1];
  if (place >= rows.back()[0]) return rows.back()[1];
  const auto after =
      std::ranges::upper_bound(rows, place, {}, [](const auto& row) { return row[0]; });
  const auto [from, low] = *(after - 1);
  const auto [to, high] = *after;
  const double share = (place - from) / (to - from);
  // Exact at the ends, and without an overflow of the difference.
  return (1.0 - share) * low + share * high;
}

}  // namespace peristat
