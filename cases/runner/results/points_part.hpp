#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "cases/runner/results/hdf5_file.hpp"
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

/// Writes the group /points, which tells images apart.
void write_points(Hdf5File& file, const Points& points, const std::vector<PointCounts>& counts);

/// Bytes of what it writes.
[[nodiscard]] std::uint64_t bytes_of(const Points& points, const std::vector<PointCounts>& counts);

/// Whether a group that write_points has written is of these points and sets, to the last bit.
[[nodiscard]] bool holds_points(const Hdf5File& file, const std::string& group,
                                const Points& points);

}  // namespace peristat
