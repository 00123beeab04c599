#include "cases/runner/results/tables/line_table.hpp"

#include "solvers/observe/point_fields.hpp"
#include "solvers/observe/probe.hpp"

namespace peristat {

LineTable line_table(const ProbeSpecification& probe, int dimension) {
  using Kind = Column::Kind;
  LineTable table{
      probe.name,
      {{Kind::integer, "step", "1", "number of the accepted step"},
       {Kind::number, "load_factor", "1", "load factor of the step"},
       {Kind::integer, "point", "1", "number of the point"},
       {Kind::number, "distance", "m", "distance of the point from the start, along the line"}}};
  for (int c = 0; c < dimension; ++c) {
    table.columns.push_back({Kind::number, {"xyz"[c]}, "m", "reference position of the point"});
  }
  const PointField& field = *point_field(probe.field);
  for (const std::string& component : chosen_components(probe, dimension)) {
    const std::string name = component.empty() ? field.name : field.name + "_" + component;
    table.columns.push_back({Kind::number, name, field.unit, name + " of the point"});
  }
  return table;
}

std::vector<Row> line_rows(const std::vector<LineValues>& line, int dimension,
                           const StepRecord& record) {
  std::vector<Row> rows;
  for (const LineValues& at : line) {
    Row row{std::int64_t{record.step}, record.load_factor, at.point, at.distance};
    row.insert(row.end(), at.reference.begin(), at.reference.begin() + dimension);
    row.insert(row.end(), at.values.begin(), at.values.end());
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace peristat
