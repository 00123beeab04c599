#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace peristat {

/// A column of a table that is written both as CSV and as an HDF5 dataset.
struct Column {
  enum class Kind { integer, number, text } kind = Kind::number;
  std::string name, unit, description;
};

/// Entry of a column: integer, number or text as the column's kind.
using TableCell = std::variant<std::int64_t, double, std::string>;
using Row = std::vector<TableCell>;

}  // namespace peristat
