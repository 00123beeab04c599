#pragma once

#include "solvers/study/body.hpp"

namespace peristat {

/// Of a body on ranks, which has to be one piece: refuses what its supports don't hold, points that
/// swing on too few bonds, and pieces. A call that all ranks make.
/// @throws InputError ("supports" or "points") on all of them
void refuse_unheld_part(const Body& body);

}  // namespace peristat
