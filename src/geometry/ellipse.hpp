#pragma once

#include "src/geometry/shape.hpp"

namespace peristat {

// Places of an ellipse by the angle t of the circle that it is stretched from:
// centre + a cos t u + b sin t v with unit vectors u and v along its axes.

/// Unit vector u along the first axis.
[[nodiscard]] Coordinates first_axis(const Ellipse& ellipse);

/// A vector's components along the ellipse's axes; the third is 0.
[[nodiscard]] Coordinates along_axes(const Ellipse& ellipse, const Coordinates& vector);

/// Angle t of the nearest place on an ellipse with radii a and b about the origin, whose axes are
/// x and y: the root of (b^2 - a^2) sin t cos t + a x sin t - b y cos t that lies in the quadrant
/// of the place, by bisection to the last bit. Of two places equally near it is one.
[[nodiscard]] double nearest_angle(double a, double b, double x, double y);

/// Distance of a place from the ellipse, inside as outside [m].
[[nodiscard]] double distance_to(const Ellipse& ellipse, const Coordinates& place);

}  // namespace peristat
