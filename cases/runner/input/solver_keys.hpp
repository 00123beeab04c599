#pragma once

#include "cases/runner/input/key_table.hpp"

namespace peristat {

/// The search for equilibrium.
[[nodiscard]] Table<SolverSpecification> solver_keys();
[[nodiscard]] Table<SolverSpecification> arc_length_keys();
[[nodiscard]] Table<RelaxationSpecification> relaxation_keys();

/// Checks of modes that find the load instead of prescribing it.
void check_found_loads(const Entry& at, const Case& result);

}  // namespace peristat
