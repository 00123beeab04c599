#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "src/geometry/lattice.hpp"
#include "src/geometry/lattice_frame.hpp"

namespace peristat {

/// Where a point of a lattice stands, and its share of a cell's volume.
struct Site {
  Cell cell{};
  Coordinates place{};
  double share = 1.0;
  Coordinates centroid{};  ///< of the part of the cell
};

/// Sites of layers, and their numbers by layer.
struct LayerSites {
  std::vector<Site> sites;
  std::vector<std::vector<Index>> of_layer;  // ascending
};

[[nodiscard]] LatticeFrame frame_of(const Lattice& lattice);

/// Upper bound of the sites of body and layers; infinite if the lattice can't be used.
[[nodiscard]] double most_sites(const Lattice& lattice);

/// Sites of the body, in ascending order of their cells, each at its cell's place.
[[nodiscard]] std::vector<Site> body_sites(const Lattice& lattice);

/// Where body and layers, or layers of several sides, have parts of the same cell, each goes to its
/// centroid.
/// @throws InputError ("layers[0].where", "layers[0].side", ...)
[[nodiscard]] LayerSites layer_sites(const Lattice& lattice, std::vector<Site>& body);

/// Rows of places across an axis of a lattice that is not turned.
struct LatticeRows {
  int axis = 0;
  std::int64_t first = 0, last = 0;  ///< of cells along the axis, last not included
};

/// Rows in which a body of whole cells may have places.
[[nodiscard]] LatticeRows rows_of_body(const Lattice& lattice, int axis);

/// The sites of whole cells that body_sites has in these rows, in the same order.
[[nodiscard]] std::vector<Site> body_sites(const Lattice& lattice, const LatticeRows& rows);

/// The sites that layer_sites has in these rows, of whole cells; layers may have none there.
/// @param body       the body's sites in these rows
/// @param low, high  least and largest cells along each axis of all of the body's sites
[[nodiscard]] LayerSites layer_sites(const Lattice& lattice, const LatticeRows& rows,
                                     const std::vector<Site>& body, const Cell& low,
                                     const Cell& high);

/// @throws InputError for a layer without a point
[[noreturn]] void refuse_empty_layer(const Lattice& lattice, std::size_t number);

}  // namespace peristat
