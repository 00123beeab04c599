#pragma once

#include <vector>

#include "cases/runner/results/probe.hpp"
#include "src/core/communicator.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// As probe_values, of a body that ranks have parts of: of the probes of sets that are statistics
/// of a field, or an opening. A call that all ranks make, and get the same from.
/// @param points of the rank, with their ghosts
/// @param fields of the points that the rank owns
[[nodiscard]] std::vector<double> part_probe_values(const ProbeSpecification& probe,
                                                    const Points& points, const StepFields& fields,
                                                    const LoadValues& loads,
                                                    const Communicator& ranks);

}  // namespace peristat
