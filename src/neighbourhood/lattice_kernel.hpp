#pragma once

#include <array>
#include <vector>

#include "src/core/spacing.hpp"
#include "src/core/types.hpp"
#include "src/neighbourhood/kernel.hpp"

namespace peristat {

/// Steps along a lattice's axes from a point to another.
using LatticeStep = std::array<int, 3>;

/// A kernel on an unbounded lattice, evaluated once per step between points.
class LatticeKernel {
 public:
  LatticeKernel(const Kernel& kernel, const Spacing& spacing);

  /// Factor of a bond's weight beside the volumes of its points, nu omega(r') r'/r: share nu of the
  /// neighbour's cell within the horizon, and the distance r' at which it counts, that of the
  /// points or, with `exact_centroids`, of the part's centroid. 0 for points that are no
  /// neighbours, and for a point itself.
  [[nodiscard]] double factor(const LatticeStep& step) const;

  /// Distance of the points [m].
  [[nodiscard]] double distance(const LatticeStep& step) const;

  /// Steps along an axis within which neighbours may lie; 0 beyond the dimension.
  [[nodiscard]] int width(int axis) const { return width_[std::size_t(axis)]; }

  /// Calls visit(step, factor) for the neighbours of a point, in ascending order.
  template <class Visit>
  void for_each_neighbour(const Visit& visit) const {
    for (int x = -width_[0]; x <= width_[0]; ++x) {
      for (int y = -width_[1]; y <= width_[1]; ++y) {
        for (int z = -width_[2]; z <= width_[2]; ++z) {
          const LatticeStep step{x, y, z};
          const double found = factor(step);
          if (found != 0.0) visit(step, found);
        }
      }
    }
  }

 private:
  [[nodiscard]] double find_factor(const LatticeStep& step) const;

  const Kernel kernel_;
  const Spacing spacing_;
  std::array<int, 3> width_{};
  std::vector<double> factors_;  // of steps from 0 on along each axis, the last one fastest
};

}  // namespace peristat
