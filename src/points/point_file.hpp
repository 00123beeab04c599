#pragma once

#include <filesystem>

#include "src/points/points.hpp"

namespace peristat {

/// Reads points from a CSV or blank-separated text file.
///
/// The first line that is neither empty nor a comment (#) names the columns: `x`, `y`, `z` as the
/// dimension asks, `volume` [m3] and optionally `set` (names joined by `|`, or empty). Separator is
/// the comma if the header has one, otherwise blanks. Points are renumbered with locality; the
/// spacing is the (mean volume / cross_section)^(1/dimension).
/// @throws InputError with file name, line and what is wrong (missing column, not a number, not
///         finite, volume not positive, two points at one place, no points)
[[nodiscard]] Points read_points(const std::filesystem::path& file, int dimension,
                                 double cross_section);

}  // namespace peristat
