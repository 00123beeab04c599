#pragma once

#include "cases/runner/input/key_table.hpp"

namespace peristat {

/// The search for equilibrium.
[[nodiscard]] Table<SolverSpecification> solver_keys();
[[nodiscard]] Table<SolverSpecification> arc_length_keys();
[[nodiscard]] Table<RelaxationSpecification> relaxation_keys();

/// What goes with a load that is found, not given.
void check_found_loads(const Entry& at, const Case& result);

}  // namespace peristat
