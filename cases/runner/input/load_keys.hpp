#pragma once

#include "cases/runner/input/key_table.hpp"

namespace peristat {

/// Supports, loads and what else strains the body.
[[nodiscard]] Table<SupportSpecification> support_keys();
[[nodiscard]] Table<LoadSpecification> load_keys();
[[nodiscard]] Table<EigenstrainSpecification> eigenstrain_keys();
[[nodiscard]] Table<Eigenstrains> temperature_keys();
[[nodiscard]] Table<ControlTerm> control_keys();

/// A table without its only key is a slip.
void check_temperature(const Entry& at, const Case& result);

}  // namespace peristat
