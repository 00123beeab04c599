#pragma once

#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/results/line_table.hpp"
#include "cases/runner/setup/recorded_points.hpp"
#include "solvers/problem/records.hpp"
#include "src/geometry/points_on_line.hpp"

namespace peristat {

/// Points of a body along a probe's line, in their order. Probe and points must outlive it.
class LineProbe {
 public:
  LineProbe(const ProbeSpecification& probe, const RecordedPoints& points);

  /// step, load_factor, point, distance from the begin of the line, x, y, z, and the values.
  [[nodiscard]] LineTable table() const;
  /// A row per point, of all ranks. Collective.
  [[nodiscard]] std::vector<Row> rows(const StepRecord& record, const StepFields& fields) const;

 private:
  const ProbeSpecification& probe_;
  const RecordedPoints& points_;
  std::vector<PointOnLine> places_;  // of this rank
};

}  // namespace peristat
