#pragma once

#include <vector>

#include "solvers/body/body.hpp"

namespace peristat {

/// Flags of degrees of freedom that have no equation here: prescribed ones and those of ghosts.
[[nodiscard]] std::vector<char> without_equation(const Body& body);

}  // namespace peristat
