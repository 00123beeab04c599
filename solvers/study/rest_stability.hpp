#pragma once

#include "solvers/body/body.hpp"
#include "solvers/study/study_options.hpp"

namespace peristat {

/// Refuses a body that is unstable at rest. Without negative constants the tangent at rest is a sum
/// of positive semidefinite terms. With a negative C2 or C3 the body may be unstable before
/// anything is loaded: its energy then has no minimum, and the results of a run are arbitrary. The
/// tangent is factorised to check this or, if the linear solver is iterative, conjugate gradients
/// search for a direction of negative curvature.
/// @throws InputError if the body is unstable at rest
void refuse_unstable_rest(const Body& body, const StudyOptions& options);

}  // namespace peristat
