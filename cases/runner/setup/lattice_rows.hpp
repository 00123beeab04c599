#pragma once

#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"

namespace peristat {

/// Rows of a lattice's points, to which cracks lock. Measured in 2D (docs/theory.md, "Lattice
/// rows"): below T* = -0.1 a crack in mixed mode runs along a row where it should turn; it turns
/// between points of blue noise.
inline constexpr double locking_t_star = -0.1;

/// K_II over K above which a crack should turn by more than 3 degrees, if T is 0.
inline constexpr double turning_share = 0.03;

/// Angle within which a crack is taken to lie along a row [degrees].
inline constexpr double along_row = 10.0;

/// True if the points stand on a lattice, unperturbed, and bonds of theirs may fail.
[[nodiscard]] bool has_rows_to_lock_to(const Case& from);

/// Keys of the straight initial cracks along rows to which they may lock: lines of the lattice (3D:
/// planes) along axes and diagonals. A crack in a plane of symmetry is left out, as it can't turn.
[[nodiscard]] std::vector<std::string> cracks_along_rows(const Case& from);

}  // namespace peristat
