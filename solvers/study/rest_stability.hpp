#pragma once

#include "solvers/study/body.hpp"
#include "solvers/study/study_options.hpp"

namespace peristat {

/// At rest the tangent is a sum of positive semidefinite terms where no constant is negative. With
/// a negative C2 or C3 the body may be unstable before anything is loaded: its energy then has no
/// least value, and what a run finds is arbitrary. The tangent is factorised to tell, or, where the
/// linear solver is iterative, conjugate gradients look for a direction of negative
/// curvature.
/// @throws InputError if the body is unstable at rest
void refuse_unstable_rest(const Body& body, const StudyOptions& options);

}  // namespace peristat
