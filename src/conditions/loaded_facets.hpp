#pragma once

#include <string>

#include "src/conditions/pressed_boundary.hpp"
#include "src/conditions/traction.hpp"

namespace peristat {

/// Adds to a boundary facets of a mesh: those that the group has which the load's `set` names; if
/// it names no facets, those of the elements (or all of whose nodes are) in the set; and with a
/// `side` those that face it, without a set those on the outermost plane. A corner moves with the
/// points at the elements around it and those next to them, or at the nodes of the elements around
/// it; among very many with the nearest.
/// @throws InputError (KEY.set, KEY.side) if there are none
void add_pressed_facets(const Points& points, const LoadSpecification& load, const std::string& key,
                        PressedBoundary& boundary);

/// Area of each facet that a traction's load names in the same way, given to the point at its
/// element, or in equal parts to the points at its nodes.
/// @throws InputError as above, and (KEY.depth) for a depth of a horizon
[[nodiscard]] TractionAreas facet_areas(const Points& points, const LoadSpecification& load,
                                        const std::string& key);

}  // namespace peristat
