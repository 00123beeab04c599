#pragma once

#include <cmath>

#include "src/core/types.hpp"

namespace peristat {

// Vectors of plain doubles. The kernels have their own over any scalar:
// src/measures/small_algebra.hpp.

inline double dot(const Coordinates& a, const Coordinates& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline Coordinates plus(const Coordinates& a, const Coordinates& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

inline Coordinates minus(const Coordinates& a, const Coordinates& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

inline Coordinates scaled(double factor, const Coordinates& a) {
  return {factor * a[0], factor * a[1], factor * a[2]};
}

inline Coordinates cross(const Coordinates& a, const Coordinates& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline double length(const Coordinates& a) { return std::hypot(a[0], a[1], a[2]); }

/// Direction of a nonzero vector.
inline Coordinates unit(const Coordinates& a) { return scaled(1.0 / length(a), a); }

}  // namespace peristat
