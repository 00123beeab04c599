#pragma once

#include "cases/runner/input/key_table.hpp"

namespace peristat {

/// Supports, loads, eigenstrains, temperature and displacement control.
[[nodiscard]] Table<SupportSpecification> support_keys();
[[nodiscard]] Table<LoadSpecification> load_keys();
[[nodiscard]] Table<EigenstrainSpecification> eigenstrain_keys();
[[nodiscard]] Table<Eigenstrains> temperature_keys();
[[nodiscard]] Table<ControlTerm> control_keys();

/// Refuses a table [temperature] without its only key.
void check_temperature(const Entry& at, const Case& result);

}  // namespace peristat
