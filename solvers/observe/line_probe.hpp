#pragma once

#include <cstdint>
#include <vector>

#include "solvers/observe/point_fields.hpp"
#include "solvers/observe/probe_specification.hpp"
#include "solvers/observe/recorded_points.hpp"
#include "src/geometry/points_on_line.hpp"

namespace peristat {

/// A point on a probe's line.
struct LineValues {
  std::int64_t point = 0;      ///< number in the results
  double distance = 0.0;       ///< from the begin of the line, along it [m]
  Coordinates reference{};     ///< [m]
  std::vector<double> values;  ///< one per chosen component
};

/// Points of a body along a probe's line, in their order. Probe and points must outlive it.
class LineProbe {
 public:
  LineProbe(const ProbeSpecification& probe, const RecordedPoints& points);

  [[nodiscard]] const ProbeSpecification& probe() const { return probe_; }
  /// The points of all ranks. Collective.
  /// @param fields of the points that are recorded here: the probe's
  [[nodiscard]] std::vector<LineValues> values(const PointValues& fields) const;

 private:
  const ProbeSpecification& probe_;
  const RecordedPoints& points_;
  std::vector<PointOnLine> places_;  // of this rank
};

}  // namespace peristat
