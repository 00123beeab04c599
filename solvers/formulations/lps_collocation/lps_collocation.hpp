#pragma once

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// The linear peridynamic solid by collocation ([LPS]).
[[nodiscard]] const Formulation& lps_collocation_formulation();

}  // namespace peristat
