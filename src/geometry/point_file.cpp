#include "src/geometry/point_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include "src/core/decimal.hpp"
#include "src/core/expression.hpp"
#include "src/core/input_error.hpp"
#include "src/core/nearest_name.hpp"
#include "src/core/number_text.hpp"
#include "src/core/table_text.hpp"
#include "src/geometry/coincident_points.hpp"
#include "src/geometry/numbering.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// A point as the file has it.
struct PointRow {
  std::size_t line = 0;
  Coordinates place{};
  double volume = 0.0;
  std::string_view sets{};        ///< names joined by |
  std::vector<double> further{};  ///< values of the further columns, in their order
};

class PointReader {
 public:
  PointReader(const std::filesystem::path& file, int dimension, double length_unit)
      : file_(file), dimension_(dimension), length_unit_(length_unit) {}

  /// Calls visit(row) for every point, in the order of the file.
  void for_each_point(const std::function<void(const PointRow&)>& visit) {
    columns_.clear();
    further_.clear();
    count_ = 0;
    for_each_row(file_, [&](std::size_t line, std::string_view text) {
      line_ = line;
      columns_.empty() ? read_header(text) : visit(read_point(text));
    });
    if (columns_.empty()) refuse_file("no line names the columns, which are " + allowed_columns());
    if (count_ == 0) refuse_file("the file has no points");
  }

  [[nodiscard]] Index count() const { return count_; }
  /// Names of the further columns, in their order; known once the points have been read.
  [[nodiscard]] const std::vector<std::string>& further() const { return further_; }

  /// Reads no more than the names of the columns.
  void read_names() {
    columns_.clear();
    further_.clear();
    first_row(file_, [&](std::size_t line, std::string_view text) {
      line_ = line;
      read_header(text);
    });
    if (columns_.empty()) refuse_file("no line names the columns, which are " + allowed_columns());
  }

  [[noreturn]] void refuse(std::size_t line, const std::string& what) const {
    throw InputError("", "", what, file_.string() + ":" + std::to_string(line));
  }

  [[noreturn]] void refuse_file(const std::string& what) const {
    throw InputError("file", file_.string(), what);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { refuse(line_, what); }

  std::vector<std::string> required_columns() const {
    std::vector<std::string> names{"x", "y", "z"};
    names.resize(std::size_t(dimension_));
    names.push_back("volume");
    return names;
  }

  std::string allowed_columns() const {
    std::string all;
    for (const std::string& name : required_columns()) all += name + ", ";
    return all + "and optionally set and columns of your own";
  }

  std::vector<std::string_view> fields(std::string_view text) const {
    return by_comma_ ? split(text, ',') : split_at_blanks(text);
  }

  void read_header(std::string_view text) {
    by_comma_ = text.find(',') != std::string_view::npos;
    const std::vector<std::string> required = required_columns();
    std::string why_not;
    if (number_in(fields(text).front(), why_not)) {
      refuse(
          "the first line that is neither empty nor a comment must name the columns, which are " +
          allowed_columns() +
          "; this one has numbers. A line of names that begins with # is a comment: remove the #");
    }
    for (const std::string_view field : fields(text)) {
      const std::string name(field);
      const bool known = name == "set" || std::count(required.begin(), required.end(), name) > 0;
      if (!known) add_further(name);
      if (std::count(columns_.begin(), columns_.end(), name)) {
        refuse("column '" + name + "' appears twice");
      }
      columns_.push_back(name);
    }
    for (const std::string& name : required) {
      if (std::count(columns_.begin(), columns_.end(), name)) continue;
      const std::string nearest = nearest_name(name, further_);
      refuse("column '" + name + "' is missing; the columns are " + allowed_columns() +
             (nearest.empty() ? "" : "; did you mean it by '" + nearest + "'?"));
    }
  }

  void add_further(const std::string& name) {
    const bool is_axis = name == "y" || name == "z";
    if (is_axis) {
      refuse("column '" + name + "' is for a higher dimension than " + std::to_string(dimension_) +
             "; the columns are " + allowed_columns());
    }
    const std::string why_not = why_no_column(name);
    if (!why_not.empty()) refuse("the name '" + name + "' of a column " + why_not);
    further_.push_back(name);
  }

  PointRow read_point(std::string_view text) {
    std::vector<std::string_view> cells = fields(text);
    const bool set_left_out = !by_comma_ && columns_.back() == "set";
    if (set_left_out && cells.size() + 1 == columns_.size()) cells.emplace_back();
    if (cells.size() != columns_.size()) {
      refuse(std::to_string(cells.size()) + " values for " + std::to_string(columns_.size()) +
             " columns");
    }
    if (count_ == std::numeric_limits<Index>::max() - 1) refuse("too many points");
    PointRow row;
    row.line = line_;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const std::string& column = columns_[k];
      if (column == "set") {
        row.sets = cells[k];
        for (const std::string_view name : split(row.sets, '|')) check_name(name);
      } else if (column == "volume") {
        row.volume = number(column, cells[k], 3);
        if (!(row.volume > 0)) refuse("volume = " + std::string(cells[k]) + " must be positive");
      } else if (column == "x" || column == "y" || column == "z") {
        row.place[std::size_t(column[0] - 'x')] = number(column, cells[k], 1);
      } else {
        row.further.push_back(number(column, cells[k], 0));
      }
    }
    ++count_;
    return row;
  }

  /// Results have a dataset named after each set.
  void check_name(std::string_view name) const {
    constexpr std::size_t longest = 100;
    if (name == ".") refuse("a set can't be called '.'; use letters, digits, _ and -");
    if (name.size() > longest) {
      refuse("the name of a set has " + std::to_string(name.size()) + " characters; at most " +
             std::to_string(longest) + " are allowed");
    }
  }

  /// A number in the unit of length to a power, in SI units.
  double number(const std::string& column, std::string_view text, int power) const {
    std::string why_not;
    std::optional<double> value = number_in(text, why_not);
    if (value && length_unit_ != 1.0) {
      value = tens_ ? shifted_decimal(text, power * *tens_)
                    : std::optional(*value * std::pow(length_unit_, power));
      why_not = "is too large or too small in units of " + number_text(length_unit_) + " m";
    }
    if (!value || !std::isfinite(*value))
      refuse(column + " = '" + std::string(text) + "' " + why_not);
    return *value;
  }

  /// The exponent of a power of ten, by which numbers are converted without rounding them twice.
  static std::optional<int> tens_of(double number) {
    const double tens = std::round(std::log10(number));
    if (shifted_decimal("1", static_cast<int>(tens)) != number) return std::nullopt;
    return static_cast<int>(tens);
  }

  std::filesystem::path file_;
  int dimension_;
  double length_unit_;
  std::optional<int> tens_ = tens_of(length_unit_);
  std::size_t line_ = 0;
  Index count_ = 0;
  bool by_comma_ = false;
  std::vector<std::string> columns_;
  std::vector<std::string> further_;  // of them, those that expressions alone use
};

/// Points of a file, all or some of them.
class Collection {
 public:
  explicit Collection(int dimension) { points.dimension = dimension; }

  /// Names the further columns, also for a part without points.
  void name_columns(const std::vector<std::string>& names) {
    for (const std::string& name : names) points.columns[name];
    columns_.clear();
    for (const std::string& name : names) columns_.push_back(&points.columns[name]);
  }
  void add(const PointRow& row) {
    name_sets(row);
    for (const std::string_view name : split(row.sets, '|')) {
      if (name.empty()) continue;
      std::vector<Index>& set = points.sets.at(std::string(name));
      if (set.empty() || set.back() != points.count()) set.push_back(points.count());
    }
    points.reference.insert(points.reference.end(), row.place.begin(),
                            row.place.begin() + points.dimension);
    points.volume.push_back(row.volume);
    for (std::size_t k = 0; k < columns_.size(); ++k) columns_[k]->push_back(row.further[k]);
    lines_.push_back(row.line);
  }
  /// Registers the sets of a point that is not added: all ranks know all names.
  void name_sets(const PointRow& row) {
    for (const std::string_view name : split(row.sets, '|')) {
      if (!name.empty()) points.sets.try_emplace(std::string(name));
    }
  }

  void refuse_shared_places(const PointReader& reader) const {
    const auto pair = points_at_one_place(points, same_place_tolerance * points.spacing);
    if (!pair) return;
    const auto [first, second] = *pair;
    reader.refuse(lines_[second], "the point at " +
                                      place_text(points.position(second), points.dimension) +
                                      " has the same position as the point in line " +
                                      std::to_string(lines_[first]));
  }

  Points points;

 private:
  std::vector<std::size_t> lines_;             // per point
  std::vector<std::vector<double>*> columns_;  // in the order of the file
};

double spacing_of(double mean_volume, double cross_section, int dimension,
                  const PointReader& reader) {
  const double spacing = std::pow(mean_volume / cross_section, 1.0 / dimension);
  if (!std::isfinite(spacing) || !(spacing > 0)) {
    reader.refuse_file("the mean volume " + number_text(mean_volume) + " gives no usable spacing");
  }
  return spacing;
}

void check_cross_section(double cross_section) {
  if (std::isfinite(cross_section) && cross_section > 0) return;
  throw InputError("cross_section", number_text(cross_section), "must be positive and finite");
}

/// Data of the whole file that the numbers of points depend on.
struct WholeFile {
  Coordinates low, high;
  double spacing = 0.0;
};

WholeFile look_at_file(PointReader& reader, int dimension, double cross_section) {
  WholeFile whole;
  whole.low.fill(std::numeric_limits<double>::infinity());
  whole.high.fill(-std::numeric_limits<double>::infinity());
  reader.for_each_point([&](const PointRow& row) {
    for (std::size_t c = 0; c < 3; ++c) {
      whole.low[c] = std::min(whole.low[c], row.place[c]);
      whole.high[c] = std::max(whole.high[c], row.place[c]);
    }
  });
  const Index count = reader.count();
  double mean = 0.0;
  reader.for_each_point([&](const PointRow& row) { mean += row.volume / count; });
  whole.spacing = spacing_of(mean, cross_section, dimension, reader);
  return whole;
}

}  // namespace

std::vector<std::int32_t> source_rows(const std::filesystem::path& file, const Points& points,
                                      Index count, double length_unit) {
  std::vector<Index> by_place(static_cast<std::size_t>(count));
  std::iota(by_place.begin(), by_place.end(), Index(0));
  const auto stands_before = [&](Index a, Index b) {
    return points.position(a) < points.position(b);
  };
  std::sort(by_place.begin(), by_place.end(), stands_before);
  std::vector<std::int32_t> rows(by_place.size(), -1);
  PointReader reader(file, points.dimension, length_unit);
  reader.for_each_point([&](const PointRow& row) {
    const auto found = std::lower_bound(
        by_place.begin(), by_place.end(), row.place,
        [&](Index point, const Coordinates& at) { return points.position(point) < at; });
    if (found == by_place.end() || points.position(*found) != row.place) return;
    rows[static_cast<std::size_t>(*found)] = reader.count() - 1;
  });
  return rows;
}

std::vector<std::string> further_columns(const std::filesystem::path& file, int dimension) {
  PointReader reader(file, dimension, 1.0);
  reader.read_names();
  return reader.further();
}

Points read_points(const std::filesystem::path& file, int dimension, double cross_section,
                   const std::optional<NeighbourFile>& neighbours, double length_unit) {
  check_cross_section(cross_section);
  PointReader reader(file, dimension, length_unit);
  reader.read_names();
  Collection read(dimension);
  read.name_columns(reader.further());
  reader.for_each_point([&](const PointRow& row) { read.add(row); });
  Points& points = read.points;
  double mean = 0.0;
  for (const double volume : points.volume) mean += volume / points.count();
  points.spacing = spacing_of(mean, cross_section, dimension, reader);
  read.refuse_shared_places(reader);
  if (neighbours) points.neighbours = read_neighbours(*neighbours, points);
  return renumbered(points, locality_order(dimension, points.spacing, points.reference));
}

Part read_slab(const std::filesystem::path& file, int dimension, double cross_section,
               const Communicator& ranks, double length_unit) {
  check_cross_section(cross_section);
  PointReader reader(file, dimension, length_unit);
  const WholeFile whole = look_at_file(reader, dimension, cross_section);
  const LocalityCells cells(dimension, whole.spacing, whole.low, whole.high);
  const double rows = cells.of(whole.high.data())[0] + 1.0;
  const double first = std::floor(rows * ranks.rank() / ranks.count());
  const double last = std::floor(rows * (ranks.rank() + 1) / ranks.count());
  Collection read(dimension);
  read.name_columns(reader.further());
  read.points.spacing = whole.spacing;
  // Includes the points of the adjacent rows, which may coincide with its own.
  reader.for_each_point([&](const PointRow& row) {
    const double of_point = cells.of(row.place.data())[0];
    const bool is_near = of_point >= first - 1.0 && of_point < last + 1.0;
    is_near ? read.add(row) : read.name_sets(row);
  });
  read.refuse_shared_places(reader);

  const Points& near = read.points;
  std::vector<std::pair<LocalityCells::Key, Index>> places;
  for (Index i = 0; i < near.count(); ++i) {
    const LocalityCells::Key cell = cells.of(&near.reference[std::size_t(i) * near.dimension]);
    if (cell[0] >= first && cell[0] < last) places.emplace_back(cell, i);
  }
  std::sort(places.begin(), places.end());
  std::vector<Index> order;
  for (const auto& [cell, point] : places) order.push_back(point);
  Part part;
  part.points = renumbered(near, order);
  part.owned = part.points.count();
  const Communicator::Counts counts = ranks.count_all(part.owned);
  part.whole = counts.all;
  for (Index i = 0; i < part.owned; ++i) part.number.push_back(counts.before + i);
  return part;
}

}  // namespace peristat
