#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "src/geometry/points.hpp"
#include "src/geometry/side.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Place on the lattice, counted in spacings from its frame's origin; zero beyond the dimension.
using LatticeCell = std::array<std::int64_t, 3>;

/// The cells of the points of a body on a lattice, squares or cubes of a spacing, from which its
/// boundary is found. Points of layers are not in the body.
class BodyCells {
 public:
  /// @param ranks that have parts of the body, with ghosts a spacing around their points
  /// @throws InputError (without a key) for points that stand on no lattice, and for cells that are
  ///         not whole
  explicit BodyCells(const Points& points, const Communicator& ranks = sole_rank());

  [[nodiscard]] LatticeCell cell(Index point) const;
  /// The body's point there, or -1.
  [[nodiscard]] Index point(const LatticeCell& cell) const;
  [[nodiscard]] bool is_exposed(Index point, const Side& side) const;

  /// Returns the body's outermost plane of points on a side, ascending, in front of which a layer
  /// stands. Collective; each rank gets its part of the plane.
  /// @throws InputError (without a key) if the body continues beyond a plane of symmetry or a
  ///         period
  [[nodiscard]] std::vector<Index> outermost(const Side& side) const;

  /// Returns the sides on which points make one plane of cells that is exposed there. Collective;
  /// each rank passes its part of the points.
  [[nodiscard]] std::vector<Side> exposed_sides(std::span<const Index> points) const;

 private:
  const Points& of_;
  const Communicator& ranks_;
  std::vector<std::pair<LatticeCell, Index>> cells_;  // ascending
};

/// The place next to a cell on a side.
[[nodiscard]] LatticeCell beside(LatticeCell cell, const Side& side);

}  // namespace peristat
