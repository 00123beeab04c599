#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "src/core/spacing.hpp"
#include "src/core/types.hpp"
#include "src/geometry/shape.hpp"

namespace peristat {

/// Place on a lattice, counted in spacings from the anchor; zero beyond the dimension.
using Cell = std::array<std::int64_t, 3>;

/// Part of a spacing by which a lattice place may miss the box around the shapes.
inline constexpr double grid_tolerance = 1e-9;

/// Position of a lattice: the place of cell k is R (a + (k + o) s), with the anchor a, the offset o
/// of places in spacings s along the lattice's axes, and the rotation R about the z axis through
/// the origin. Quarter turns are exact; without rotation every place is unchanged to the last bit.
class LatticeFrame {
 public:
  /// @param angle of R, anticlockwise [degrees]; 0 in 1D
  LatticeFrame(int dimension, const Coordinates& anchor, double offset, const Spacing& spacing,
               double angle);

  [[nodiscard]] int dimension() const { return dimension_; }
  [[nodiscard]] const Spacing& spacing() const { return spacing_; }
  [[nodiscard]] bool is_turned() const { return sine_ != 0.0 || cosine_ != 1.0; }

  /// Position of a place [m]; the origin is met exactly, so that sets may be split there.
  [[nodiscard]] Coordinates position(const Cell& cell) const;

  /// Rotates a vector from the lattice's axes to those of the body.
  [[nodiscard]] Coordinates turned(const Coordinates& along_lattice) const;

  /// A position in spacings from the anchor along the lattice's axes: the inverse of `position`.
  [[nodiscard]] Coordinates spacings_to(const Coordinates& place) const;

  /// Calls visit(cell), in ascending order, for every cell whose place lies in the box or within a
  /// part of the cell beside it; for some more if the lattice is turned. Visits nothing if the box
  /// is not bounded.
  /// @param beside in spacings; on a turned lattice in diagonals
  void for_each_cell(const Box& box, double beside,
                     const std::function<void(const Cell&)>& visit) const;

  /// Numbers of places along the axes in the range of for_each_cell; infinite if the box is not
  /// bounded.
  [[nodiscard]] std::array<double, 3> counts(const Box& box, double beside) const {
    return range_of(box, beside).count;
  }

  /// First place along each axis, and their number; double, so that nothing overflows.
  struct Range {
    std::array<double, 3> first{}, count{1.0, 1.0, 1.0};
  };
  /// Range of for_each_cell; infinite numbers if the box is not bounded.
  [[nodiscard]] Range range_of(const Box& box, double beside) const;

  /// Upper bound of the cells that for_each_cell visits; infinite if the box is not bounded.
  [[nodiscard]] double most_places(const Box& box, double beside) const;

  /// Half a cell's diagonal [m].
  [[nodiscard]] double half_diagonal() const;

 private:
  /// First and last place, along the second axis, of a row that may lie in the box.
  [[nodiscard]] std::array<double, 2> part_in(const Box& box, double beside, double row,
                                              const Range& range) const;

  int dimension_;
  Coordinates anchor_;  // turned
  double offset_;
  Spacing spacing_;
  double cosine_ = 1.0, sine_ = 0.0;
};

}  // namespace peristat
