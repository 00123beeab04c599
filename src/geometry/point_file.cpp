#include "src/geometry/point_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "src/core/input_error.hpp"
#include "src/core/nearest_name.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/numbering.hpp"
#include "src/geometry/table_text.hpp"

namespace peristat {
namespace {

/// Part of the spacing within which two points stand at one place.
constexpr double same_place_tolerance = 1e-9;

/// Two points whose coordinates differ by no more than the tolerance, the one read first in front.
///
/// Points are sorted by coarse cells of four tolerances, once with the cells as they are and once
/// shifted by half a cell in each combination of directions: one of these sortings puts such a pair
/// into one cell. A cell cannot hold many points that are further apart, so this is O(n log n).
std::optional<std::pair<Index, Index>> points_at_one_place(const Points& points, double tolerance) {
  using Key = std::pair<std::array<double, 3>, Index>;
  const int dimension = points.dimension;
  std::vector<Key> keys(points.count());
  for (int shifted = 0; shifted < 1 << dimension; ++shifted) {
    for (Index point = 0; point < points.count(); ++point) {
      const Coordinates place = points.position(point);
      keys[point] = {{}, point};
      for (int c = 0; c < dimension; ++c) {
        const double shift = shifted >> c & 1 ? 0.5 : 0.0;
        keys[point].first[c] = std::floor(place[c] / (4 * tolerance) + shift);
      }
    }
    std::sort(keys.begin(), keys.end());
    for (std::size_t a = 0; a < keys.size(); ++a) {
      for (std::size_t b = a + 1; b < keys.size() && keys[b].first == keys[a].first; ++b) {
        const Coordinates one = points.position(keys[a].second);
        const Coordinates other = points.position(keys[b].second);
        double distance = 0.0;
        for (int c = 0; c < 3; ++c) distance = std::max(distance, std::abs(one[c] - other[c]));
        if (distance <= tolerance) return std::pair(keys[a].second, keys[b].second);
      }
    }
  }
  return std::nullopt;
}

class Reader {
 public:
  Reader(const std::filesystem::path& file, int dimension) : file_(file) {
    points_.dimension = dimension;
  }

  Points read(double cross_section, const std::optional<NeighbourFile>& neighbours) {
    for_each_row(file_, [&](std::size_t line, std::string_view text) {
      line_ = line;
      columns_.empty() ? read_header(text) : read_point(text);
    });
    if (columns_.empty()) refuse_file("no line names the columns, which are " + allowed_columns());
    if (points_.count() == 0) refuse_file("the file has no points");
    finish(cross_section, neighbours);
    return std::move(points_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { refuse(line_, what); }

  [[noreturn]] void refuse(std::size_t line, const std::string& what) const {
    throw InputError("", "", what, file_.string() + ":" + std::to_string(line));
  }

  [[noreturn]] void refuse_file(const std::string& what) const {
    throw InputError("file", file_.string(), what);
  }

  std::vector<std::string> required_columns() const {
    std::vector<std::string> names{"x", "y", "z"};
    names.resize(points_.dimension);
    names.push_back("volume");
    return names;
  }

  std::string allowed_columns() const {
    std::string all;
    for (const std::string& name : required_columns()) all += name + ", ";
    return all + "and optionally set";
  }

  std::vector<std::string_view> fields(std::string_view text) const {
    return by_comma_ ? split(text, ',') : split_at_blanks(text);
  }

  void read_header(std::string_view text) {
    by_comma_ = text.find(',') != std::string_view::npos;
    const std::vector<std::string> required = required_columns();
    for (const std::string_view field : fields(text)) {
      const std::string name(field);
      const bool known = name == "set" || std::count(required.begin(), required.end(), name) > 0;
      if (!known) {
        std::vector<std::string> candidates = required;
        candidates.push_back("set");
        const std::string nearest = nearest_name(name, candidates);
        refuse("unknown column '" + name + "'; the columns are " + allowed_columns() +
               (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
      }
      if (std::count(columns_.begin(), columns_.end(), name)) {
        refuse("column '" + name + "' appears twice");
      }
      columns_.push_back(name);
    }
    for (const std::string& name : required) {
      if (std::count(columns_.begin(), columns_.end(), name)) continue;
      refuse("column '" + name + "' is missing; the columns are " + allowed_columns());
    }
  }

  void read_point(std::string_view text) {
    std::vector<std::string_view> cells = fields(text);
    const bool set_left_out = !by_comma_ && columns_.back() == "set";
    if (set_left_out && cells.size() + 1 == columns_.size()) cells.emplace_back();
    if (cells.size() != columns_.size()) {
      refuse(std::to_string(cells.size()) + " values for " + std::to_string(columns_.size()) +
             " columns");
    }
    const Index point = points_.count();
    if (point == std::numeric_limits<Index>::max() - 1) refuse("too many points");
    Coordinates place{};
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const std::string& column = columns_[k];
      if (column == "set") {
        add_to_sets(point, cells[k]);
      } else if (column == "volume") {
        const double volume = number(column, cells[k]);
        if (!(volume > 0)) refuse("volume = " + std::string(cells[k]) + " must be positive");
        points_.volume.push_back(volume);
      } else {
        place[column[0] - 'x'] = number(column, cells[k]);
      }
    }
    points_.reference.insert(points_.reference.end(), place.begin(),
                             place.begin() + points_.dimension);
    lines_.push_back(line_);
  }

  double number(const std::string& column, std::string_view text) const {
    const std::string shown = column + " = '" + std::string(text) + "'";
    std::string why_not;
    const std::optional<double> value = number_in(text, why_not);
    if (!value) refuse(shown + " " + why_not);
    return *value;
  }

  void add_to_sets(Index point, std::string_view names) {
    for (const std::string_view name : split(names, '|')) {
      if (name.empty()) continue;
      std::vector<Index>& set = points_.sets[std::string(name)];
      if (set.empty() || set.back() != point) set.push_back(point);
    }
  }

  void finish(double cross_section, const std::optional<NeighbourFile>& neighbours) {
    double mean = 0.0;
    for (const double volume : points_.volume) mean += volume / points_.count();
    points_.spacing = std::pow(mean / cross_section, 1.0 / points_.dimension);
    if (!std::isfinite(points_.spacing) || !(points_.spacing > 0)) {
      refuse_file("the mean volume " + number_text(mean) + " gives no usable spacing");
    }
    if (const auto pair = points_at_one_place(points_, same_place_tolerance * points_.spacing)) {
      const auto [first, second] = *pair;
      refuse(lines_[second],
             "the point at " + place_text(points_.position(second), points_.dimension) +
                 " stands at the place of the point in line " + std::to_string(lines_[first]));
    }
    if (neighbours) points_.neighbours = read_neighbours(*neighbours, points_);
    points_ =
        renumbered(points_, locality_order(points_.dimension, points_.spacing, points_.reference));
  }

  std::filesystem::path file_;
  std::size_t line_ = 0;
  bool by_comma_ = false;
  std::vector<std::string> columns_;
  Points points_;
  std::vector<std::size_t> lines_;  // per point, before renumbering
};

}  // namespace

Points read_points(const std::filesystem::path& file, int dimension, double cross_section,
                   const std::optional<NeighbourFile>& neighbours) {
  if (!(std::isfinite(cross_section) && cross_section > 0)) {
    throw InputError("cross_section", number_text(cross_section), "must be positive and finite");
  }
  return Reader(file, dimension).read(cross_section, neighbours);
}

}  // namespace peristat
