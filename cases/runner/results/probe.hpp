#pragma once

#include <span>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/results/results.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Columns that a probe adds to the history.
[[nodiscard]] ProbeColumns columns_of(const ProbeSpecification& probe, int dimension);

/// Mean of the probe's field over the points of its set, one value per component; for
/// "poisson_ratio" that of the homogeneous deformation that fits the set best, for "opening" the
/// mean displacement of the set minus that of the other, and for "crack_length" the extent along
/// the axis of the bonds across it that are broken or cut.
/// @param separated all bonds that have broken so far and those that pre-cracks have cut
[[nodiscard]] std::vector<double> probe_values(const ProbeSpecification& probe,
                                               const Points& points, const StepFields& fields,
                                               std::span<const BondEnds> separated);

}  // namespace peristat
