#pragma once

#include <span>

#include "assembly/operators/tangent.hpp"
#include "solvers/linear/free_dofs.hpp"
#include "solvers/linear/trilinos/matrix_preconditioner.hpp"
#include "src/core/sharing.hpp"

namespace peristat {

/// Returns K_ff: rows and columns of the free degrees of freedom, both triangles. Collective if the
/// body is partitioned.
/// @param sharing partition of the body, whose ghosts have columns here but no equations
[[nodiscard]] CompressedRows compressed_rows(const Tangent& tangent, const FreeDofs& free,
                                             const Sharing* sharing = nullptr);

/// Returns the point and component of each equation.
[[nodiscard]] EquationBlocks equation_blocks(const FreeDofs& free);

/// Returns the translations along the axes and the rotations about them (2D: about z; 1D: none) at
/// the free degrees of freedom, one after the other. Lengths are divided by the body's, so that all
/// entries are of order one. Collective if the body is partitioned.
/// @param positions points x dimension, row major [m]
/// @param sharing partition of the body; null: the body is not partitioned
[[nodiscard]] NearNullSpace rigid_motions(std::span<const double> positions, const FreeDofs& free,
                                          const Sharing* sharing = nullptr);

}  // namespace peristat
