#pragma once

#include <cstddef>
#include <vector>

#include "cases/runner/results/files/table.hpp"

namespace peristat {

/// Table load_displacement.csv: step, load_factor, with a displacement control `control`, and for
/// all that the case drives displacement_y:NAME [m] beside force_y:NAME [N], the load there or the
/// reaction. Its rows are parts of the rows of the history.
class LoadDisplacement {
 public:
  /// @param history columns of the history
  LoadDisplacement(const std::vector<Column>& history, bool has_control);

  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  [[nodiscard]] Row row(const Row& of_history) const;
  [[nodiscard]] std::vector<Row> rows(const std::vector<Row>& of_history) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::size_t> source_;  // column of the history, per column
};

}  // namespace peristat
