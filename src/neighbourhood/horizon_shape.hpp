#pragma once

#include "src/core/types.hpp"

namespace peristat {

/// Shape of a neighbourhood {xi: |xi| <= horizon}, by the norm: Euclid's, that of the largest
/// component, or that of their sum.
enum class HorizonShape { ball, box, diamond };

/// Norm of a vector in a shape's axes [as the vector].
[[nodiscard]] double norm_of(HorizonShape shape, const Coordinates& vector);

/// Length of the longest vector of norm 1.
[[nodiscard]] double farthest_of(HorizonShape shape, int dimension);

/// Mean over all directions n of norm(n)^-power: the ratio of an integral over the shape to that
/// over the ball, if the integrand is a power of the length times a function of the norm,
/// int f(norm(xi)) |xi|^k dV = (int over the ball) * mean_of_reach(k + dimension).
[[nodiscard]] double mean_of_reach(HorizonShape shape, int dimension, int power);

}  // namespace peristat
