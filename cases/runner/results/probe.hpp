#pragma once

#include <string>
#include <vector>

#include "cases/runner/build/recorded_points.hpp"
#include "cases/runner/input/case.hpp"
#include "cases/runner/results/crack_measures.hpp"
#include "cases/runner/results/results.hpp"

namespace peristat {

/// The load parameters of a step, which expressions may use.
struct LoadValues {
  std::vector<std::string> names{};
  std::vector<double> values{};
};

/// Components that a probe looks at; one without a name of a scalar.
[[nodiscard]] std::vector<std::string> chosen_components(const ProbeSpecification& probe,
                                                         int dimension);

/// The components that a probe of a field looks at, of a point.
[[nodiscard]] std::vector<double> values_at(const ProbeSpecification& probe, int dimension,
                                            const StepFields& fields, Index point);

/// Columns that a probe of a set or a point adds to the history.
[[nodiscard]] ProbeColumns columns_of(const ProbeSpecification& probe, int dimension);

/// Mean, largest or smallest value of the probe's field over the points of its set, or its value at
/// the point nearest to a place (of points as near the one with the lowest number), one value per
/// component; for "poisson_ratio" that of the homogeneous deformation that fits the set best, for
/// "opening" the mean displacement of the set minus that of the other, and what a CrackMeasure
/// tells. Of an error, one value: the root mean square or the largest of |v - v_expected|. A call
/// that all ranks make, and get the same from.
/// @param fields of the points that are recorded here
/// @throws InputError ("expected[c]") if an expected value is not finite
[[nodiscard]] std::vector<double> probe_values(const ProbeSpecification& probe,
                                               const RecordedPoints& points,
                                               const StepFields& fields, const CrackState& crack,
                                               const LoadValues& loads = {});

}  // namespace peristat
