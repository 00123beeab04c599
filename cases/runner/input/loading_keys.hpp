#pragma once

#include "cases/runner/input/key_table.hpp"

namespace peristat {

/// The way of the loads, and its steps.
[[nodiscard]] Table<LoadingSpecification> loading_keys();

/// The motion in time.
[[nodiscard]] Table<InitialSpecification> initial_keys();
[[nodiscard]] Table<AbsorbingSpecification> absorbing_keys();
[[nodiscard]] Table<DynamicsSpecification> dynamics_keys();

/// Supports and loads are read as soon as it is known whether they are expressions of the time, and
/// settings of the solver as soon as it is known whether steps search equilibria.
void ask_for_dynamics(const Entry& at, Case& result);
/// What goes with a motion in time, and what goes with it alone.
void check_dynamics(const Entry& at, const Case& result);

}  // namespace peristat
