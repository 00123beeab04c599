#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace peristat {

/// Cells of points that are known as convex polygons (2D) or intervals (1D).
struct CellPolygons {
  std::vector<std::size_t> offset{};  ///< first corner of each point's cell, and the end; or empty
  /// Relative to the point's place [m]: polygons anticlockwise, intervals by both ends in (x, 0).
  std::vector<std::array<double, 2>> corners{};

  [[nodiscard]] bool empty() const { return offset.empty(); }
  void append(const std::vector<std::array<double, 2>>& cell) {
    if (offset.empty()) offset.push_back(0);
    corners.insert(corners.end(), cell.begin(), cell.end());
    offset.push_back(corners.size());
  }
  [[nodiscard]] std::vector<std::array<double, 2>> of(std::size_t point) const {
    const auto at = [&](std::size_t k) { return corners.begin() + std::ptrdiff_t(offset[k]); };
    return {at(point), at(point + 1)};
  }
};

}  // namespace peristat
