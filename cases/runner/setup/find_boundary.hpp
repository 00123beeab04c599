#pragma once

#include "cases/runner/input/case.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Finds the faces of a collocated lattice body of model "lps", for tractions; does nothing for
/// other bodies. Collective.
/// @param points of the body, or of the part that a rank has
void find_boundary(const Case& from, const Points& points, const Communicator& ranks,
                   BodySpecification& of);

}  // namespace peristat
