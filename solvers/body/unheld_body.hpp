#pragma once

#include "solvers/body/body.hpp"

namespace peristat {

/// @throws InputError ("supports", "cracks" or "points") if a part of the body may move freely, or
///         points have too few bonds
void refuse_unheld_bodies(const Body& body);

}  // namespace peristat
