#pragma once

#include "assembly/terms/term.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

[[nodiscard]] InteractionCount bond_count(const Bonds& bonds);

}  // namespace peristat
