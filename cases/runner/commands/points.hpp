#pragma once

#include <filesystem>
#include <string>

#include "cases/runner/input/case.hpp"
#include "cases/runner/process/failure.hpp"

namespace peristat {

/// What the command `points` asks for.
struct PointsQuestion {
  std::filesystem::path mesh;
  int dimension = 0;              ///< 0: 3 if the mesh has solids, else 2
  std::string length_unit = "m";  ///< of the coordinates in the file
  double thickness = 1.0;         ///< [m]
  PointsAt at = PointsAt::elements;
  std::filesystem::path output;  ///< empty: nothing is written
};

/// The command `points`: prints what a mesh has, with a horizon to choose, and writes its points as
/// a file that points.file reads.
/// @throws InputError for a mesh that a case could not read, and for an output that is not new, not
///         empty and not written by this command
[[nodiscard]] Exit print_points(const PointsQuestion& question);

}  // namespace peristat
