#pragma once

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

}  // namespace peristat
