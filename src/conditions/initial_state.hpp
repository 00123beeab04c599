#pragma once

#include <vector>

#include "src/conditions/specification.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Initial state of a motion; arrays are points x dimension.
struct InitialState {
  std::vector<double> displacement;  ///< [m]
  std::vector<double> velocity;      ///< [m/s]
};

/// Adds the values of all specifications at a point, as for loads. Images have none of their own.
/// @throws InputError ("initial[k].set", "initial[k].displacement[c]", …) for a set that is unknown
///         or empty, a bad expression, and a value that is not finite, with its place
[[nodiscard]] InitialState make_initial_state(const Points& points,
                                              const std::vector<InitialSpecification>& initial);

}  // namespace peristat
