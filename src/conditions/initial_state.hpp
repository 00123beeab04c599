#pragma once

#include <vector>

#include "src/conditions/specification.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// What a motion begins with; arrays are points x dimension.
struct InitialState {
  std::vector<double> displacement;  ///< [m]
  std::vector<double> velocity;      ///< [m/s]
};

/// What several specifications give to a point adds up, as loads do. Images have none of their own.
/// @throws InputError ("initial[k].set", "initial[k].displacement[c]", …) for a set that is unknown
///         or empty, a bad expression, and a value that is not finite, with its place
[[nodiscard]] InitialState make_initial_state(const Points& points,
                                              const std::vector<InitialSpecification>& initial);

}  // namespace peristat
