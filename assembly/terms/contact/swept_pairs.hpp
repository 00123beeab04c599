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

}  // namespace peristat
