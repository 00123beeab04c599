#pragma once

#include <array>
#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

/// Cells of one spacing with keys by their positions along the body's directions: the longest
/// direction slowest, then the shortest, so that the rows of the fastest are long.
class LocalityCells {
 public:
  using Key = std::array<double, 3>;  // double, so that nothing overflows

  /// @param low, high the least and the largest of all points' coordinates [m]
  LocalityCells(int dimension, const Spacing& spacing, const Coordinates& low,
                const Coordinates& high);

  /// Key of the cell at a position, slowest direction first.
  [[nodiscard]] Key of(const double* position) const;
  [[nodiscard]] int slowest() const { return directions_[0]; }

 private:
  [[nodiscard]] double along(double coordinate, int direction) const;

  int dimension_;
  Spacing spacing_;
  Coordinates low_;
  std::array<int, 3> directions_{0, 1, 2};
};

/// Order of the points in which neighbours have close numbers: cells of one spacing, sorted with
/// the longest direction of the body slowest. This keeps the band of the tangent as narrow as the
/// body's cross section, which a shuffled numbering would not (products run 2 to 9 times slower
/// there), and rows of alike points long (see bond_runs).
/// @return old numbers in the new order
[[nodiscard]] std::vector<Index> locality_order(int dimension, const Spacing& spacing,
                                                const std::vector<double>& reference);

/// Points renumbered: new point k is old point order[k]; sets follow. Points missing in the order
/// are left out, with the neighbour pairs that they are in.
[[nodiscard]] Points renumbered(const Points& points, const std::vector<Index>& order);

}  // namespace peristat
