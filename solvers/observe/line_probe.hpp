#pragma once

#include <cstdint>
#include <vector>

#include "solvers/observe/point_fields.hpp"
#include "solvers/observe/probe_specification.hpp"
#include "solvers/observe/recorded_points.hpp"

namespace peristat {

/// A point on a probe's line.
struct LineValues {
  std::int64_t point = 0;      ///< number in the results
  double distance = 0.0;       ///< from the begin of the line, along it [m]
  Coordinates reference{};     ///< [m]
  std::vector<double> values;  ///< one per chosen component
};

/// Values of a probe at all points along its line, of all ranks, in their order. Collective.
/// @param fields of the points that are recorded here: the probe's
[[nodiscard]] std::vector<LineValues> line_values(const ProbeSpecification& probe,
                                                  const RecordedPoints& points,
                                                  const PointValues& fields);

}  // namespace peristat
