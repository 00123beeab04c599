#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "src/geometry/lattice.hpp"
#include "src/geometry/lattice_frame.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Position of a point of a lattice, and its share of a cell's volume.
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
  std::vector<double> standing;              ///< number of sites of each layer before its `where`
};

/// A box that holds everything.
[[nodiscard]] Box everywhere();

[[nodiscard]] LatticeFrame frame_of(const Lattice& lattice);

/// Upper bound of the sites of body and layers; infinite if the lattice can't be used.
[[nodiscard]] double most_sites(const Lattice& lattice);

/// Sites of the body, in ascending order of their cells, each at its cell's place.
/// @param window where sites are wanted: there may be some beyond it, and those within
///        `depth_of_window` inside its sides may be wrong
[[nodiscard]] std::vector<Site> body_sites(const Lattice& lattice,
                                           const Box& window = everywhere());

/// How much a window must exceed the region in which sites have to be right, along each axis [m].
[[nodiscard]] double depth_of_window(const Lattice& lattice);

/// Data of the whole body that layers need.
struct OutermostOfBody {
  Cell low{}, high{};  ///< least and largest cells along each of the lattice's axes
  /// Heights of the flat faces that layers stand in front of, in their order [m]; none where layers
  /// are copies of the outermost plane.
  std::vector<std::pair<Side, double>> faces{};
};

/// @param body sites of the body on this rank, each of them on one rank (collective)
/// @throws InputError ("shapes", "layers[0].side") on all ranks
[[nodiscard]] OutermostOfBody outermost_of_body(const Lattice& lattice,
                                                const std::vector<Site>& body,
                                                const Communicator& ranks);

/// Returns the sites of layers. If body and layers, or layers of several sides, have parts of the
/// same cell, the site of each part moves to the part's centroid.
/// @param body sites of the body in the window
/// @throws InputError ("layers[0].where")
[[nodiscard]] LayerSites layer_sites(const Lattice& lattice, const OutermostOfBody& outermost,
                                     std::vector<Site>& body, const Box& window = everywhere());

/// @param layers those of this rank (collective)
/// @throws InputError for a layer without a point, on all ranks
void refuse_empty_layers(const Lattice& lattice, const LayerSites& layers,
                         const Communicator& ranks);

}  // namespace peristat
