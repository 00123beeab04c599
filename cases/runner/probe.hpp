#pragma once

#include <vector>

#include "cases/runner/case.hpp"
#include "src/results/results.hpp"

namespace peristat {

/// Columns that a probe adds to the history.
[[nodiscard]] ProbeColumns columns_of(const ProbeSpecification& probe, int dimension);

/// Mean of the probe's field over the points of its set, one value per component; for
/// "poisson_ratio" that of the homogeneous deformation that fits the set best, for "opening" the
/// mean displacement of the set minus that of the other, and for "crack_length" the extent along
/// the axis of the set's points whose damage has reached the threshold.
[[nodiscard]] std::vector<double> probe_values(const ProbeSpecification& probe,
                                               const Points& points, const StepFields& fields);

}  // namespace peristat
