#pragma once

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// The ordinary state-based solid at finite strain.
[[nodiscard]] const Formulation& state_formulation();

}  // namespace peristat
