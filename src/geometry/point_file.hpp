#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "src/geometry/neighbour_file.hpp"
#include "src/geometry/part.hpp"
#include "src/geometry/points.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Reads points from a CSV or blank-separated text file.
///
/// The first line that is neither empty nor a comment (#) names the columns: `x`, `y`, `z` as the
/// dimension asks, `volume` [m3], optionally `set` (names joined by `|`, or empty), and any further
/// ones with numbers, which become Points::columns. Separator is
/// the comma if the header has one, otherwise blanks; in a blank-separated file the last column may
/// be left empty if it is `set`. Decimals have a point, whatever the locale. Points are renumbered
/// with locality; the spacing is the (mean volume / cross_section)^(1/dimension).
/// @throws InputError with "FILE:LINE" as its place for a missing column, one whose name
///         expressions can't use, a value that is not a number or not finite, a volume that is not
///         positive, and two points at one place; with "file" for a file that can't be read or has
///         no points
/// @param length_unit unit of the coordinates, whose cube is that of the volumes [m]
/// @param neighbours their neighbours, if they are given; points are numbered there from 1 in the
///        order of the file
[[nodiscard]] Points read_points(const std::filesystem::path& file, int dimension,
                                 double cross_section,
                                 const std::optional<NeighbourFile>& neighbours = {},
                                 double length_unit = 1.0);

/// Names of the further columns of a file of points, in their order.
/// @throws InputError as read_points does for the line of names
[[nodiscard]] std::vector<std::string> further_columns(const std::filesystem::path& file,
                                                       int dimension);

/// Row in the file, from 0, of each of the first `count` points, found by position; -1: none. The
/// points are all of the file or those of a part.
[[nodiscard]] std::vector<std::int32_t> source_rows(const std::filesystem::path& file,
                                                    const Points& points, Index count,
                                                    double length_unit = 1.0);

/// A slab of the points of read_points, without ghosts, as make_slab's: every rank reads the file,
/// and keeps no more than a slab. Collective.
/// @throws InputError as read_points does; for two points at one place perhaps on one rank alone
[[nodiscard]] Part read_slab(const std::filesystem::path& file, int dimension, double cross_section,
                             const Communicator& ranks, double length_unit = 1.0);

}  // namespace peristat
