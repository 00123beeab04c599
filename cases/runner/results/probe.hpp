#pragma once

#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/results/crack_measures.hpp"
#include "cases/runner/results/results.hpp"
#include "cases/runner/setup/recorded_points.hpp"

namespace peristat {

/// The load parameters of a step, which expressions may use.
struct LoadValues {
  std::vector<std::string> names{};
  std::vector<double> values{};
};

/// Components that a probe evaluates; for a scalar one without a name.
[[nodiscard]] std::vector<std::string> chosen_components(const ProbeSpecification& probe,
                                                         int dimension);

/// Values of these components at a point.
[[nodiscard]] std::vector<double> values_at(const ProbeSpecification& probe, int dimension,
                                            const StepFields& fields, Index point);

/// Columns that a probe of a set or a point adds to the history.
[[nodiscard]] ProbeColumns columns_of(const ProbeSpecification& probe, int dimension);

/// Values of a probe, one per component: mean, largest or smallest value of its field over the
/// points of its set, or its value at the point nearest to a place (of points equally near, the one
/// with the lowest number). For "poisson_ratio" that of the homogeneous deformation that fits the
/// set best, for "opening" the mean displacement of the set minus that of the other, for a
/// CrackMeasure its value.
/// For an error, one value: the root mean square or the largest of |v - v_expected|.
/// Collective; all ranks get the same.
/// @param fields of the points that are recorded here
/// @throws InputError ("expected[c]") if an expected value is not finite
[[nodiscard]] std::vector<double> probe_values(const ProbeSpecification& probe,
                                               const RecordedPoints& points,
                                               const StepFields& fields, const CrackState& crack,
                                               const LoadValues& loads = {});

}  // namespace peristat
