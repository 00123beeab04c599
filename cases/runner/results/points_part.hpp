#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "cases/runner/results/hdf5_file.hpp"
#include "cases/runner/results/point_rows.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Pure numbers of every point that do not change, e.g. counts of neighbours.
struct PointCounts {
  std::string name;  ///< of the dataset in /points
  std::string description;
  std::variant<std::vector<std::int32_t>, std::vector<double>> values;
};

/// Path of a set's flags, one per point.
[[nodiscard]] std::string flags_of(const std::string& set);

/// Writes the group /points.
/// @param gathering null: the points are all; otherwise they, and the counts, are those that this
///        rank owns, and while rank 0 writes all others send_points
void write_points(Hdf5File& file, const Points& points, const std::vector<PointCounts>& counts,
                  const RowGathering* gathering = nullptr);
void send_points(const Points& points, const std::vector<PointCounts>& counts,
                 const RowGathering& gathering);

/// Bytes of what it writes.
/// @param rows points of the body
[[nodiscard]] std::uint64_t bytes_of(const Points& points, const std::vector<PointCounts>& counts,
                                     std::uint64_t rows);

/// Whether a group that write_points has written is of these points and sets, to the last bit.
/// @param file      null on ranks that rank 0 reads for
/// @param gathering null: the points are all; otherwise they are those that this rank owns, which
/// is
///                  what it is told of by this call that all ranks make
[[nodiscard]] bool holds_points(const Hdf5File* file, const std::string& group,
                                const Points& points, const RowGathering* gathering);

}  // namespace peristat
