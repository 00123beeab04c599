#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "src/core/types.hpp"
#include "src/geometry/shape.hpp"

namespace peristat {

/// Boxes by the cells of a regular grid that they overlap, to find those near a place quickly.
class BoxGrid {
 public:
  BoxGrid() = default;
  /// @param cell size of the cells [m]; they are larger if there would be more than some 8 per box
  BoxGrid(int dimension, const std::vector<Box>& boxes, double cell);

  /// True if is_wanted(box number) is true for some box that overlaps a region. Asks for a box once
  /// per cell that both overlap.
  template <class IsWanted>
  [[nodiscard]] bool any_near(const Box& region, const IsWanted& is_wanted) const {
    const Range low = cell_at(region.min), high = cell_at(region.max);
    for (std::size_t x = low[0]; x <= high[0]; ++x) {
      for (std::size_t y = low[1]; y <= high[1]; ++y) {
        for (std::size_t z = low[2]; z <= high[2]; ++z) {
          const std::size_t cell = (x * cells_[1] + y) * cells_[2] + z;
          if (cell + 1 >= offset_.size()) continue;
          for (std::size_t k = offset_[cell]; k < offset_[cell + 1]; ++k) {
            if (is_wanted(std::size_t(members_[k]))) return true;
          }
        }
      }
    }
    return false;
  }

  [[nodiscard]] double bytes() const {
    return double(offset_.size() * sizeof(std::size_t) + members_.size() * sizeof(Index));
  }

 private:
  using Range = std::array<std::size_t, 3>;
  /// Cell of a place, the nearest one if it is outside of the grid.
  [[nodiscard]] Range cell_at(const Coordinates& place) const;

  Coordinates low_{};
  double cell_ = 1.0;
  Range cells_{1, 1, 1};
  std::vector<std::size_t> offset_{};
  std::vector<Index> members_{};
};

/// Smallest box around places, larger by a distance on all sides of the dimension.
[[nodiscard]] Box box_with(const std::vector<Coordinates>& places, int dimension, double larger);

[[nodiscard]] bool do_overlap(const Box& one, const Box& other, int dimension);

}  // namespace peristat
