#pragma once

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// Bonds that stretch by their squared lengths, by convolutions ([FCBM]).
[[nodiscard]] const Formulation& green_bond_formulation();

}  // namespace peristat
