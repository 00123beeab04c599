#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

/// The smallest box of a lattice's places that holds all points of a body, along the lattice's
/// axes.
struct LatticeBox {
  int dimension = 0;
  std::array<Index, 3> extent{1, 1, 1};  ///< places along each axis; 1 beyond the dimension
  std::vector<Index> place;              ///< of each point: (k_0 n_1 + k_1) n_2 + k_2

  [[nodiscard]] std::size_t count() const {
    return std::size_t(extent[0]) * std::size_t(extent[1]) * std::size_t(extent[2]);
  }
  /// The numbers k of a place.
  [[nodiscard]] std::array<Index, 3> numbers(Index of_place) const {
    const Index row = of_place / extent[2];
    return {row / extent[1], row % extent[1], of_place % extent[2]};
  }
};

/// Images count as points.
/// @param why_not why there is none: "the points stand on no lattice", ...
[[nodiscard]] std::optional<LatticeBox> lattice_box(const Points& points, std::string& why_not);

}  // namespace peristat
