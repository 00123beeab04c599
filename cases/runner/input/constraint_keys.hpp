#pragma once

#include "cases/runner/input/key_table.hpp"

namespace peristat {

/// Constraints other than supports, foundations and obstacles.
[[nodiscard]] Table<RigidSetSpecification> rigid_set_keys();
[[nodiscard]] Table<RollerSpecification> roller_keys();
[[nodiscard]] Table<LinearConstraintSpecification> linear_constraint_keys();
[[nodiscard]] Table<FoundationSpecification> foundation_keys();
[[nodiscard]] Table<ObstacleSpecification> obstacle_keys();
[[nodiscard]] Table<SymmetryPlane> symmetry_keys();
[[nodiscard]] Table<PeriodSpecification> period_keys();

}  // namespace peristat
