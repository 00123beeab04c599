#pragma once

#include "assembly/terms/term.hpp"
#include "src/neighbourhood/neighbour_counts.hpp"

namespace peristat {

[[nodiscard]] inline InteractionCount bond_count(const Bonds& bonds) {
  return {"bonds", weighted_bonds(bonds), "neighbours", "neighbours within the horizon, #N1",
          neighbour_counts(bonds)};
}

}  // namespace peristat
