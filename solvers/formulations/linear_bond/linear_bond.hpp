#pragma once

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// Bonds that stretch by the displacements along them, for small ones: sums over bonds, or
/// convolutions.
[[nodiscard]] const Formulation& linear_bond_formulation();

}  // namespace peristat
