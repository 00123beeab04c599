#pragma once

#include <algorithm>
#include <cmath>

#include "src/core/types.hpp"

namespace peristat {

/// Distances of a lattice's points along its axes [m]. Converts to one number: the edge of the
/// square or cube of the same volume, (s_1 ... s_d)^(1/d), which is also the mean spacing of a
/// cloud. For equal distances it is that distance to the last bit.
class Spacing {
 public:
  Spacing(double everywhere = 0.0)  // one number is a lattice of squares or cubes
      : along_{everywhere, everywhere, everywhere}, edge_(everywhere) {}

  /// @param along per axis; entries beyond the dimension are ignored
  Spacing(const Coordinates& along, int dimension) : Spacing(along[0]) {
    double volume = 1.0;
    for (int c = 0; c < dimension; ++c) {
      along_[c] = along[c];
      volume *= along[c];
    }
    if (!is_square()) edge_ = std::pow(volume, 1.0 / dimension);
    for (int c = dimension; c < 3; ++c) along_[c] = edge_;
  }

  operator double() const { return edge_; }

  [[nodiscard]] double along(int axis) const { return along_[axis]; }
  [[nodiscard]] double largest() const { return *std::max_element(along_.begin(), along_.end()); }
  /// True if cells are squares or cubes.
  [[nodiscard]] bool is_square() const { return along_[1] == along_[0] && along_[2] == along_[0]; }

 private:
  Coordinates along_;
  double edge_;
};

}  // namespace peristat
