#pragma once

#include "src/core/communicator.hpp"
#include "src/geometry/numbered_points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Gives a bond that several ranks have the same length and weight on all of them, to the last bit,
/// so that they judge it alike: whatever kind its bond got of those that each rank has found first,
/// and in whatever order a surface correction has summed. All ranks then have one table of kinds,
/// or none of them has one. A call that all make.
/// @param bonds of the part that these points are of
void agree_on_kinds(Bonds& bonds, const Points& points, const NumberedPoints& numbered,
                    const Communicator& ranks);

}  // namespace peristat
