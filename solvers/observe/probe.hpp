#pragma once

#include <string>
#include <vector>

#include "solvers/observe/crack_measures.hpp"
#include "solvers/observe/observation.hpp"
#include "solvers/observe/probe_specification.hpp"
#include "solvers/observe/recorded_points.hpp"

namespace peristat {

/// The load parameters of a step, which expressions may use.
struct LoadValues {
  std::vector<std::string> names{};
  std::vector<double> values{};
};

/// Quantities of a whole set, which single points don't have: poisson_ratio, opening and the crack
/// measures.
[[nodiscard]] const std::vector<std::string>& fields_of_whole_sets();

/// Components that a probe evaluates; for a scalar one without a name.
[[nodiscard]] std::vector<std::string> chosen_components(const ProbeSpecification& probe,
                                                         int dimension);

/// Values of these components at a point.
[[nodiscard]] std::vector<double> values_at(const ProbeSpecification& probe, int dimension,
                                            const PointValues& fields, Index point);

/// Values of a probe, one per component: mean, largest or smallest value of its field over the
/// points of its set, or its value at the point nearest to a place (of points equally near, the one
/// with the lowest number). For "poisson_ratio" that of the homogeneous deformation that fits the
/// set best, for "opening" the mean displacement of the set minus that of the other, for a
/// CrackMeasure its value.
/// For an error, one value: the root mean square or the largest of |v - v_expected|.
/// Collective; all ranks get the same.
/// @param fields of the points that are recorded here: the probe's, for poisson_ratio and opening
///        the displacement
/// @throws InputError ("expected[c]") if an expected value is not finite
[[nodiscard]] std::vector<double> probe_values(const ProbeSpecification& probe,
                                               const RecordedPoints& points,
                                               const PointValues& fields, const CrackState& crack,
                                               const LoadValues& loads = {});

/// The same in a state, with the fields that the probe needs.
/// @param crack for crack measures, see SeparatedBonds
/// @throws InputError ("probe[0].set", "field", "component", …) also for a probe that the
///         body can't answer
[[nodiscard]] std::vector<double> probe_values(const ProbeSpecification& probe, Observation& in,
                                               const CrackState& crack = {},
                                               const LoadValues& loads = {});

}  // namespace peristat
