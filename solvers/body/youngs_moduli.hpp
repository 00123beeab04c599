#pragma once

#include <vector>

#include "solvers/body/body.hpp"

namespace peristat {

/// Young's modulus of each point's material [Pa].
[[nodiscard]] std::vector<double> youngs_moduli(const Body& body);

}  // namespace peristat
