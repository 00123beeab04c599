#pragma once

#include "cases/runner/input/case.hpp"
#include "cases/runner/setup/recorded_points.hpp"

namespace peristat {

/// Refuses probes of sets that are not there, and of places off the body, which would be
/// represented by a distant point. Collective.
/// @throws InputError ("probe[k].set", "probe[k].at", ...)
void require_places_of_probes(const Case& from, const RecordedPoints& recorded);

}  // namespace peristat
