#include "cases/runner/results/line_probe.hpp"

#include "cases/runner/input/probe_fields.hpp"
#include "cases/runner/results/probe.hpp"

namespace peristat {
LineProbe::LineProbe(const ProbeSpecification& probe, const Points& points)
    : probe_(probe), points_(points), places_(points_on_line(points, *probe.from, *probe.to)) {}

LineTable LineProbe::table() const {
  using Kind = Column::Kind;
  LineTable table{probe_.name,
                  {{Kind::integer, "step", "1", "number of the accepted step"},
                   {Kind::number, "load_factor", "1", "load factor of the step"},
                   {Kind::integer, "point", "1", "number of the point"},
                   {Kind::number, "distance", "m", "of the point from the begin, along the line"}}};
  for (int c = 0; c < points_.dimension; ++c) {
    table.columns.push_back({Kind::number, {"xyz"[c]}, "m", "reference position of the point"});
  }
  const ProbeField& field = *probe_field(probe_.field);
  for (const std::string& component : chosen_components(probe_, points_.dimension)) {
    const std::string name = component.empty() ? field.name : field.name + "_" + component;
    table.columns.push_back({Kind::number, name, field.unit, name + " of the point"});
  }
  return table;
}

std::vector<Row> LineProbe::rows(const StepRecord& record, const StepFields& fields) const {
  std::vector<Row> rows;
  for (const auto& [distance, point] : places_) {
    Row row{std::int64_t{record.step}, record.load_factor, std::int64_t{point}, distance};
    const Coordinates at = points_.position(point);
    for (int c = 0; c < points_.dimension; ++c) row.emplace_back(at[std::size_t(c)]);
    for (const double value : values_at(probe_, points_.dimension, fields, point)) {
      row.emplace_back(value);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace peristat
