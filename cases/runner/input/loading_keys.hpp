#pragma once

#include "cases/runner/input/key_table.hpp"

namespace peristat {

/// The loading programme and its steps.
[[nodiscard]] Table<LoadingSpecification> loading_keys();

/// The motion in time.
[[nodiscard]] Table<InitialSpecification> initial_keys();
[[nodiscard]] Table<AbsorbingSpecification> absorbing_keys();
[[nodiscard]] Table<DynamicsSpecification> dynamics_keys();

/// Reads ahead if the case is a motion in time, and its scheme and start. Supports and loads are
/// then expressions of the time, and settings of the solver apply only if equilibria are searched.
void ask_for_dynamics(const Entry& at, Case& result);
/// Refuses keys that don't go with a motion in time, or that go with it alone.
void check_dynamics(const Entry& at, const Case& result);

}  // namespace peristat
