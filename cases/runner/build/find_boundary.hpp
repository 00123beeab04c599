#pragma once

#include "cases/runner/input/case.hpp"
#include "src/core/communicator.hpp"

namespace peristat {

/// The faces of a body of model "lps" by collocation, for tractions; of others, and of bodies that
/// are no lattice, nothing.
/// @param points of the body, or of the part that a rank has; a call that all ranks make
void find_boundary(const Case& from, const Points& points, const Communicator& ranks,
                   BodySpecification& of);

}  // namespace peristat
