#pragma once

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// Bonds that stretch by their lengths, at any deformation.
[[nodiscard]] const Formulation& bond_formulation();

}  // namespace peristat
