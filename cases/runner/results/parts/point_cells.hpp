#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cases/runner/results/files/hdf5_file.hpp"
#include "cases/runner/results/files/point_rows.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Shapes of cells by their numbers in VTK, besides those of MeshElements.
inline constexpr std::uint8_t vertex_cell = 1, polygon_cell = 7;

/// Cells of the points of a body for viewers: a lattice's boxes, polygons, elements of a mesh, or
/// the points themselves. Every cell has corners of its own, so that cells come apart along cracks;
/// corners are in VTK's order.
struct PointCells {
  std::vector<std::uint8_t> kind{};   ///< per point, number in VTK
  std::vector<std::int32_t> count{};  ///< of corners, per point
  std::vector<double> corners{};  ///< x, y, z of the corners of each point, one after another [m]
  /// x, y, z of the corners of any cell about its point [m]; then `corners` are the points alone.
  std::vector<double> box{};
};

/// Corners of cells with a common box.
/// @param points x, y, z of some points, one after another
[[nodiscard]] std::vector<double> boxes_about(const std::vector<double>& points,
                                              const std::vector<double>& box);

/// Sizes of the cells of a whole body.
struct CellSizes {
  std::uint64_t cells = 0, corners = 0;
  std::uint64_t most = 0;      ///< corners of a cell
  std::uint64_t topology = 0;  ///< length of the dataset `topology`
  std::uint8_t kind = 0;       ///< of all cells; 0: they differ, or are polygons

  [[nodiscard]] std::uint64_t bytes() const;  ///< of what write_cells writes, uncompressed
};

/// Returns the cells of points without images; of a part of a body, of the owned points.
[[nodiscard]] PointCells cells_of(const Points& points);

/// Collective.
[[nodiscard]] CellSizes sizes_of(const PointCells& cells, const RowGathering& gathering);

/// Cells and their sizes. Bodies with more corners than an int32 can count get points as cells.
/// Collective.
struct CellsOfBody {
  CellsOfBody(const Points& points, const RowGathering& gathering);
  PointCells cells;
  CellSizes sizes;
};

/// Writes the group /points/cells: corners, connectivity, offsets, types and, if the cells' kinds
/// differ, topology, for results.xdmf and results.vtkhdf. Collective.
/// @param file null on ranks that send only
void write_cells(Hdf5File* file, const PointCells& cells, const CellSizes& sizes,
                 const RowGathering& gathering);

}  // namespace peristat
