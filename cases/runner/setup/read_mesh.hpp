#pragma once

#include <filesystem>

#include "src/geometry/mesh.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

struct PointSource;

/// Reads a mesh by Debian's meshio: starts cases/runner/meshes/read_mesh.py, which is found beside
/// the program or the library, and reads its output. Nothing is left behind.
/// @param length_unit unit of the coordinates in the file [m]
/// @throws InputError ("file") for a file that meshio can't read, and if Python or meshio are
///         missing
/// @throws MachineError if no process can be started
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& file, double length_unit);

/// Points of a mesh as a case asks for them, with the inside that bonds must not leave.
/// @throws InputError as read_mesh, make_mesh_body and make_points do
[[nodiscard]] Points read_mesh_points(const PointSource& source, int dimension);

}  // namespace peristat
