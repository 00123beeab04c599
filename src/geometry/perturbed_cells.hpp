#pragma once

#include <array>
#include <vector>

#include "src/geometry/cell_polygons.hpp"
#include "src/geometry/lattice_sites.hpp"

namespace peristat {

/// Corners of a lattice's cell from its middle [m].
[[nodiscard]] std::vector<std::array<double, 2>> whole_cell(const Lattice& lattice);

/// Shifts the corners that lie between cells of the body alone, each by up to the lattice's
/// cell_perturbation, moves the sites to the centroids of their cells and sets their shares of a
/// whole cell. Cells at the boundary keep the corners on it, so that all cells fill the body as
/// before. A shift depends on the seed and the corner's place on the lattice alone.
/// @param body whole cells in ascending order
/// @return the cells of the sites
CellPolygons perturb_cells(const Lattice& lattice, std::vector<Site>& body);

}  // namespace peristat
