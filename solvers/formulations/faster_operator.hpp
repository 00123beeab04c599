#pragma once

#include "solvers/formulations/specification/body_specification.hpp"

namespace peristat {

/// Returns the operator that sums a body's forces faster in a motion by explicit steps. Other runs,
/// which need more than forces, get bonds; bodies that only convolutions can sum get these.
[[nodiscard]] ForceOperator faster_operator(const BodySpecification& from, const Points& points,
                                            bool is_explicit);

/// True if only convolutions can sum the forces.
[[nodiscard]] bool needs_convolutions(const BodySpecification& of);

}  // namespace peristat
