#pragma once

#include <vector>

#include "cases/runner/case.hpp"
#include "src/results/results.hpp"

namespace peristat {

/// Columns that a probe adds to the history.
[[nodiscard]] ProbeColumns columns_of(const ProbeSpecification& probe, int dimension);

/// Mean of the probe's field over the points of its set, one value per component; for
/// "poisson_ratio" that of the homogeneous deformation that fits the set best.
[[nodiscard]] std::vector<double> probe_values(const ProbeSpecification& probe,
                                               const Points& points, const StepFields& fields);

}  // namespace peristat
