#pragma once

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// The linear peridynamic solid as an energy, or, by convolutions, as it was printed ([FCBM] A-8).
[[nodiscard]] const Formulation& lps_energy_formulation();

}  // namespace peristat
