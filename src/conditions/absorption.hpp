#pragma once

#include <vector>

#include "src/conditions/specification.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Damping rate eta per point, dv/dt = -eta v in addition to its forces [1/s]; empty without
/// layers. Rates of several layers add up. Images have rate 0.
/// @throws InputError ("absorbing[k].set", "absorbing[k].rate") as add_field_of_place does, and for
///         a rate that is negative somewhere
[[nodiscard]] std::vector<double> absorption_rates(
    const Points& points, const std::vector<AbsorbingSpecification>& absorbing);

}  // namespace peristat
