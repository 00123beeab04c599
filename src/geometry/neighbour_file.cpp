#include "src/geometry/neighbour_file.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/core/table_text.hpp"
#include "src/geometry/squared_distance.hpp"

namespace peristat {
namespace {

/// Relative tolerance of the largest distance, for the digits of a file.
constexpr double reach_tolerance = 1e-6;

struct Row {
  Index from = 0, to = 0;
  double share = 0.0;          // of to's volume
  std::optional<double> back;  // of from's
  std::size_t line = 0;
};

class NeighbourReader {
 public:
  NeighbourReader(const NeighbourFile& from, const Points& points) : from_(from), points_(points) {}

  std::vector<NeighbourShares> read() {
    for_each_row(from_.file, [&](std::size_t line, std::string_view text) {
      line_ = line;
      has_header_ ? read_row(text) : read_header(text);
    });
    if (rows_.empty()) {
      throw InputError("neighbours", from_.file.string(),
                       has_header_ ? "the file has no neighbours"
                                   : "no line names the columns, which are " + columns());
    }
    return pairs();
  }

 private:
  [[noreturn]] void refuse(std::size_t line, const std::string& what) const {
    throw InputError("", "", what, from_.file.string() + ":" + std::to_string(line));
  }

  static std::string columns() { return "i, j, w_ij and optionally w_ji"; }

  [[nodiscard]] std::vector<std::string_view> fields(std::string_view text) const {
    return by_comma_ ? split(text, ',') : split_at_blanks(text);
  }

  void read_header(std::string_view text) {
    has_header_ = true;
    by_comma_ = text.find(',') != std::string_view::npos;
    const std::vector<std::string_view> names = fields(text);
    const std::vector<std::string_view> known{"i", "j", "w_ij", "w_ji"};
    has_back_ = names.size() == known.size();
    if (names.size() + 1 < known.size() || names.size() > known.size() ||
        !std::equal(names.begin(), names.end(), known.begin())) {
      refuse(line_, "the first line must name the columns, which are " + columns() +
                        " in this order, not '" + std::string(text) + "'");
    }
  }

  [[nodiscard]] double number(const char* column, std::string_view text) const {
    std::string why_not;
    const std::optional<double> value = number_in(text, why_not);
    if (!value) refuse(line_, std::string(column) + " = '" + std::string(text) + "' " + why_not);
    return *value;
  }

  [[nodiscard]] Index point(const char* column, std::string_view text) const {
    const double given = number(column, text);
    if (given != std::floor(given) || given < 1.0 || given > points_.count()) {
      refuse(line_, std::string(column) + " = " + std::string(text) +
                        " is not a point; points are numbered from 1 to " +
                        std::to_string(points_.count()) + " in the order of their file");
    }
    return Index(given) - 1;
  }

  [[nodiscard]] double share(const char* column, std::string_view text) const {
    const double value = number(column, text);
    // Computed shares of whole cells may miss 1 by round-off.
    if (!(value >= 0.0 && value <= 1.0 + reach_tolerance)) {
      refuse(line_, std::string(column) + " = " + std::string(text) +
                        " must be from 0 to 1: it is the share of the neighbour's volume that "
                        "counts");
    }
    return value;
  }

  void read_row(std::string_view text) {
    const std::vector<std::string_view> cells = fields(text);
    const std::size_t wanted = has_back_ ? 4 : 3;
    if (cells.size() != wanted) {
      refuse(line_,
             std::to_string(cells.size()) + " values for " + std::to_string(wanted) + " columns");
    }
    Row row{point("i", cells[0]), point("j", cells[1]), share("w_ij", cells[2]), {}, line_};
    if (has_back_) row.back = share("w_ji", cells[3]);
    if (row.from == row.to) {
      refuse(line_, "point " + std::string(cells[0]) + " can't be its own neighbour");
    }
    require_near(row);
    rows_.push_back(row);
  }

  [[nodiscard]] double cell_size(Index point) const {
    return std::pow(points_.volume[std::size_t(point)] / from_.cross_section,
                    1.0 / points_.dimension);
  }

  void require_near(const Row& row) const {
    const double distance =
        std::sqrt(squared_distance(points_.reference, points_.dimension, row.from, row.to));
    const double size = std::max(cell_size(row.from), cell_size(row.to));
    const double reach = from_.horizon + 0.5 * std::sqrt(double(points_.dimension)) * size;
    if (distance <= reach * (1.0 + reach_tolerance)) return;
    refuse(row.line, name_of(row) + " are " + number_text(distance) +
                         " m apart, beyond the horizon and half the diagonal of a cell, " +
                         number_text(reach) + " m");
  }

  static std::string name_of(const Row& row) {
    return "points " + std::to_string(row.from + 1) + " and " + std::to_string(row.to + 1);
  }

  /// Collects the rows of each pair, in the order of the file.
  std::vector<NeighbourShares> pairs() {
    const auto ends = [](const Row& row) { return std::minmax(row.from, row.to); };
    std::stable_sort(rows_.begin(), rows_.end(),
                     [&](const Row& a, const Row& b) { return ends(a) < ends(b); });
    std::vector<NeighbourShares> result;
    const Row *one_way = nullptr, *both_ways = nullptr;
    for (std::size_t first = 0, next; first < rows_.size(); first = next) {
      for (next = first + 1; next < rows_.size() && ends(rows_[next]) == ends(rows_[first]);)
        ++next;
      const Row& row = rows_[first];
      const bool is_both = next == first + 2 && !has_back_ && rows_[first + 1].from == row.to;
      if (next > first + 1 && !is_both) {
        refuse(rows_[next - 1].line,
               name_of(row) + " are already neighbours in line " + std::to_string(row.line));
      }
      (is_both ? both_ways : one_way) = &row;
      double share = row.share, back = is_both ? rows_[first + 1].share : row.back.value_or(share);
      if (share == 0.0 && back == 0.0) refuse(row.line, name_of(row) + " both have a share of 0");
      if (row.from > row.to) std::swap(share, back);
      result.push_back({std::min(row.from, row.to), std::max(row.from, row.to), share, back});
    }
    if (one_way != nullptr && both_ways != nullptr) {
      refuse(one_way->line, name_of(*one_way) +
                                " are given in one direction, but others, such as those in line " +
                                std::to_string(both_ways->line) +
                                ", in both directions: give every pair one row, or every pair two");
    }
    return result;
  }

  const NeighbourFile& from_;
  const Points& points_;
  std::size_t line_ = 0;
  bool has_header_ = false, by_comma_ = false, has_back_ = false;
  std::vector<Row> rows_;
};

}  // namespace

std::vector<NeighbourShares> read_neighbours(const NeighbourFile& from, const Points& points) {
  return NeighbourReader(from, points).read();
}

}  // namespace peristat
