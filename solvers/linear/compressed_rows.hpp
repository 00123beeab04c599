#pragma once

#include <span>

#include "assembly/operators/tangent.hpp"
#include "solvers/linear/free_dofs.hpp"
#include "solvers/linear/trilinos/matrix_preconditioner.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Returns K_ff: rows and columns of the free degrees of freedom, both triangles. Collective if the
/// body is partitioned.
/// @param index_map partition of the body, whose ghosts have columns here but no equations
[[nodiscard]] CompressedRows compressed_rows(const Tangent& tangent, const FreeDofs& free,
                                             const IndexMap& index_map = whole_body());

/// Returns the point and component of each equation.
[[nodiscard]] EquationBlocks equation_blocks(const FreeDofs& free);

/// Returns the translations along the axes and the rotations about them (2D: about z; 1D: none) at
/// the free degrees of freedom, one after the other. Lengths are divided by the body's, so that all
/// entries are of order one. Collective if the body is partitioned.
/// @param positions points x dimension, row major [m]
/// @param index_map of the body's points
[[nodiscard]] NearNullSpace rigid_motions(std::span<const double> positions, const FreeDofs& free,
                                          const IndexMap& index_map = whole_body());

}  // namespace peristat
