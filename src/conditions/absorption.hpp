#pragma once

#include <vector>

#include "src/conditions/specification.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Rate eta per point at which layers absorb its velocity, dv/dt = -eta v beside its forces [1/s];
/// empty without layers. Of several layers it adds up. Images have none of their own.
/// @throws InputError ("absorbing[k].set", "absorbing[k].rate") as add_field_of_place does, and for
///         a rate that is negative somewhere
[[nodiscard]] std::vector<double> absorption_rates(
    const Points& points, const std::vector<AbsorbingSpecification>& absorbing);

}  // namespace peristat
