#include "cases/runner/results/tables/load_displacement.hpp"

#include <string>

namespace peristat {

LoadDisplacement::LoadDisplacement(const std::vector<Column>& history, bool has_control) {
  const auto add = [&](const std::string& name, const std::string& as) {
    for (std::size_t k = 0; k < history.size(); ++k) {
      if (history[k].name != name) continue;
      columns_.push_back(history[k]);
      columns_.back().name = as;
      source_.push_back(k);
      return true;
    }
    return false;
  };
  add("step", "step");
  add("load_factor", "load_factor");
  if (has_control) add("control", "control");
  const std::string start = "displacement_";
  for (const Column& column : history) {
    if (!column.name.starts_with(start) || column.name.find(':') != start.size() + 1) continue;
    const std::string of = column.name.substr(start.size());  // "y:top"
    add(column.name, column.name);
    if (!add("force_" + of, "force_" + of)) add("reaction_" + of, "force_" + of);
  }
}

Row LoadDisplacement::row(const Row& of_history) const {
  Row row;
  for (const std::size_t column : source_) row.push_back(of_history.at(column));
  return row;
}

std::vector<Row> LoadDisplacement::rows(const std::vector<Row>& of_history) const {
  std::vector<Row> rows;
  for (const Row& one : of_history) rows.push_back(row(one));
  return rows;
}

}  // namespace peristat
