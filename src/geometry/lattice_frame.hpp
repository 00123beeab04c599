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

/// Where a lattice stands: the place of cell k is R (a + (k + o) s), a the anchor, o the offset of
/// places in spacings s along the lattice's axes, R the turn about the z axis through the origin.
/// Whole quarters of a turn are exact; none leaves every place as it is to the last bit.
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

  /// A vector along the lattice's axes, in those of the body.
  [[nodiscard]] Coordinates turned(const Coordinates& along_lattice) const;

  /// A position in spacings from the anchor along the lattice's axes: the inverse of `position`.
  [[nodiscard]] Coordinates spacings_to(const Coordinates& place) const;

  /// Calls visit(cell) for every cell whose place lies in the box or beside it, by no more than a
  /// part of the cell, in ascending order; of a turned lattice some more. Nothing for a box that is
  /// not bounded.
  /// @param beside in spacings; of a turned lattice in diagonals
  void for_each_cell(const Box& box, double beside,
                     const std::function<void(const Cell&)>& visit) const;

  /// Numbers of places along the axes that such boxes of cells have; infinite if it is not bounded.
  [[nodiscard]] std::array<double, 3> counts(const Box& box, double beside) const {
    return range_of(box, beside).count;
  }

  /// First place along each axis, and their number; double, so that nothing overflows.
  struct Range {
    std::array<double, 3> first{}, count{1.0, 1.0, 1.0};
  };
  /// Of such boxes of cells; infinite numbers if the box is not bounded.
  [[nodiscard]] Range range_of(const Box& box, double beside) const;

  /// Upper bound of the cells that for_each_cell visits; infinite if the box is not bounded.
  [[nodiscard]] double most_places(const Box& box, double beside) const;

  /// Half a cell's diagonal [m].
  [[nodiscard]] double half_diagonal() const;

 private:
  /// The part of a row of places along the second axis that may lie in the box.
  [[nodiscard]] std::array<double, 2> part_in(const Box& box, double beside, double row,
                                              const Range& range) const;

  int dimension_;
  Coordinates anchor_;  // turned
  double offset_;
  Spacing spacing_;
  double cosine_ = 1.0, sine_ = 0.0;
};

}  // namespace peristat
