#pragma once

#include <string>
#include <vector>

#include "src/connectivity/crack.hpp"
#include "src/geometry/lattice.hpp"

namespace peristat {

/// A length of the body that must be large compared with horizon and spacing.
struct FeatureLength {
  enum class Kind { body, ligament, opening } kind = Kind::body;
  std::string what;   ///< "ligament beside lattice.shape[1]"
  double size = 0.0;  ///< [m]
};

/// Widths of subtracted shapes, and ligaments beside them and ahead of cracks. They are measured on
/// shapes: along the axes through the middle of a subtracted shape, from one such middle to
/// another, and along a crack.
/// @param cracks of the tables [[crack]], in their order
[[nodiscard]] std::vector<FeatureLength> feature_lengths(const Lattice& lattice,
                                                         const std::vector<Crack>& cracks);

/// Smallest width of a shape: along an axis, within the bounding box of the body, or across a
/// polygon's edge [m].
[[nodiscard]] double width_of(const Shape& shape, int dimension, const Box& body);

/// Length of the part of a straight line between two places that lies in a shape [m].
[[nodiscard]] double length_inside(const Shape& shape, int dimension, const Coordinates& from,
                                   const Coordinates& to);

}  // namespace peristat
