#pragma once

#include <string>
#include <vector>

#include "src/connectivity/crack.hpp"
#include "src/geometry/lattice.hpp"

namespace peristat {

/// A length of the body that horizon and spacing have to be small beside.
struct FeatureLength {
  enum class Kind { body, ligament, opening } kind = Kind::body;
  std::string what;   ///< "ligament beside lattice.shape[1]"
  double size = 0.0;  ///< [m]
};

/// Widths of what is subtracted, and what is left of the body beside that and ahead of cracks,
/// measured on shapes: along the axes through the middle of a subtracted shape, from one such
/// middle to another, and along a crack.
/// @param cracks of the tables [[crack]], in their order
[[nodiscard]] std::vector<FeatureLength> feature_lengths(const Lattice& lattice,
                                                         const std::vector<Crack>& cracks);

/// The least distance of two parallel lines (3D: planes) that a shape lies between, as far as that
/// is along an axis or across a polygon's edge, no more than the body has of it [m].
[[nodiscard]] double width_of(const Shape& shape, int dimension, const Box& body);

/// How long the part of a straight line from one place to another is that lies in a shape [m].
[[nodiscard]] double length_inside(const Shape& shape, int dimension, const Coordinates& from,
                                   const Coordinates& to);

}  // namespace peristat
