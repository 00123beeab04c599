#pragma once

#include "src/core/communicator.hpp"
#include "src/geometry/part.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Gives a bond between two parts the same length and weight on both ranks, to the last bit, so
/// that they judge it alike: whatever kind its bond got of those that each rank has found first,
/// and in whatever order a surface correction has summed. All ranks then have one table of kinds,
/// or none of them has one. A call that all make.
/// @param bonds of the part, none of them between ghosts
void agree_on_kinds(Bonds& bonds, const Part& part, const Communicator& ranks);

}  // namespace peristat
