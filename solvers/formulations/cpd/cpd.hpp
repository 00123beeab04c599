#pragma once

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// Continuum-kinematics-inspired peridynamics ([CPD]): bonds, triangles and tetrahedra.
[[nodiscard]] const Formulation& cpd_formulation();

/// Refuses points that are no whole square or cubic cells of a lattice.
/// @throws InputError ("material.model")
void require_whole_square_cells(const Points& points);

}  // namespace peristat
