#pragma once

#include <span>

#include "solvers/observe/probe_specification.hpp"
#include "solvers/observe/recorded_points.hpp"

namespace peristat {

/// Refuses probes of sets that are not there, and of places off the body, which would be
/// represented by a distant point. Collective.
/// @throws InputError ("probe[k].set", "probe[k].at", ...)
void require_places_of_probes(std::span<const ProbeSpecification> probes,
                              const RecordedPoints& recorded);

}  // namespace peristat
