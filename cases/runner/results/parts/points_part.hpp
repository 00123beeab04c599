#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "cases/runner/results/files/hdf5_file.hpp"
#include "cases/runner/results/files/point_rows.hpp"
#include "cases/runner/results/parts/point_cells.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Dimensionless constants of every point, e.g. counts of neighbours.
struct PointCounts {
  std::string name;  ///< of the dataset in /points
  std::string description;
  std::variant<std::vector<std::int32_t>, std::vector<double>> values;
};

/// Path of a set's flags, one per point.
[[nodiscard]] std::string flags_of(const std::string& set);

/// Writes the group /points.
/// @param points, counts and cells of the points that this rank owns; all ranks but 0 call
///        send_points at the same time
void write_points(Hdf5File& file, const Points& points, const std::vector<PointCounts>& counts,
                  const CellsOfBody& cells, const RowGathering& gathering = no_gathering());
void send_points(const Points& points, const std::vector<PointCounts>& counts,
                 const CellsOfBody& cells, const RowGathering& gathering);

/// Number of bytes that write_points writes.
/// @param rows points of the body
[[nodiscard]] std::uint64_t bytes_of(const Points& points, const std::vector<PointCounts>& counts,
                                     const CellSizes& cells, std::uint64_t rows);

/// True if a group written by write_points holds these points and sets, to the last bit.
/// @param file      null on all ranks but 0
/// Collective; the result refers to the points that this rank owns.
[[nodiscard]] bool holds_points(const Hdf5File* file, const std::string& group,
                                const Points& points, const RowGathering& gathering);

}  // namespace peristat
