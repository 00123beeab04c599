#pragma once

#include <span>

#include "assembly/energy/state.hpp"
#include "assembly/terms/contact/near_pairs.hpp"

namespace peristat {

/// Largest share of a step, from 0 to 1, within which no pair that can touch comes nearer than
/// (1 - 0.9 a) d: 0.9 of the first time at which one does, on straight ways. Pairs that are nearer
/// already are left to the barrier of their law. However long the step is, no pair is passed over.
/// @param at finite
/// @param step change of the displacement
[[nodiscard]] double longest_swept_share(const ContactPairs& pairs, const StateView& at,
                                         std::span<const double> step, NearPairs& near);

/// True if a pair that is open at both ends of a step, on straight ways, comes nearer than (1 - a)
/// d between them.
[[nodiscard]] bool passes_through(const ContactPairs& pairs, const StateView& at,
                                  std::span<const double> step, NearPairs& near);

/// Twice the longest step of a point, the most that two points approach one another [m].
[[nodiscard]] double longest_approach(const Points& points, std::span<const double> step);

}  // namespace peristat
