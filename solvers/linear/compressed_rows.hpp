#pragma once

#include <span>

#include "assembly/energy/sharing.hpp"
#include "assembly/operators/tangent.hpp"
#include "solvers/linear/free_dofs.hpp"
#include "solvers/linear/trilinos/matrix_preconditioner.hpp"

namespace peristat {

/// K_ff, the rows and columns of the free degrees of freedom, both triangles.
/// @param sharing of a part of a body, whose ghosts have no equations here, but columns; a call
/// that
///        all ranks then make
[[nodiscard]] CompressedRows compressed_rows(const Tangent& tangent, const FreeDofs& free,
                                             const Sharing* sharing = nullptr);

/// Which point and component each equation is of.
[[nodiscard]] EquationBlocks equation_blocks(const FreeDofs& free);

/// Translations along the axes and rotations about them (2D: about z; 1D: none) at the free degrees
/// of freedom, one after the other. Lengths are divided by the body's, so that all entries are of
/// order one.
/// @param positions points x dimension, row major [m]
/// @param sharing of a part of a body; a call that all ranks then make
[[nodiscard]] NearNullSpace rigid_motions(std::span<const double> positions, const FreeDofs& free,
                                          const Sharing* sharing = nullptr);

}  // namespace peristat
