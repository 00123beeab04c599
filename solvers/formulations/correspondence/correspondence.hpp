#pragma once

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// A correspondence material of St. Venant and Kirchhoff, by convolutions ([FCBM]).
[[nodiscard]] const Formulation& correspondence_formulation();

}  // namespace peristat
