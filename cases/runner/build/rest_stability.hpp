#pragma once

#include "cases/runner/build/body.hpp"

namespace peristat {

/// At rest the tangent is a sum of positive semidefinite terms where no constant is negative. With
/// a negative C2 or C3 the body may be unstable before anything is loaded: its energy then has no
/// least value, and what a run finds is arbitrary. The tangent is factorised to tell, or, where the
/// case's linear solver is iterative, conjugate gradients look for a direction of negative
/// curvature.
/// @throws InputError (with place) if the body is unstable at rest
void refuse_unstable_rest(const Case& from, const Body& body, int threads);

}  // namespace peristat
