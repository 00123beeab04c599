#pragma once

#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/parallel/communicator.hpp"
#include "src/parallel/numbered_points.hpp"

namespace peristat {

/// Gives bonds that several ranks have the same length and weight on all of them, to the last bit,
/// so that the ranks judge them alike: local kinds depend on the bonds that a rank found first, and
/// sums of a surface correction on their order. Afterwards all ranks have one table of kinds, or
/// none has one. Collective.
/// @param bonds of the part with these points
void agree_on_kinds(Bonds& bonds, const Points& points, const NumberedPoints& numbered,
                    const Communicator& ranks);

}  // namespace peristat
