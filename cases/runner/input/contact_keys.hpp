#pragma once

#include "cases/runner/input/key_table.hpp"

namespace peristat {

/// Contact of the body's points.
[[nodiscard]] Table<ContactSpecification> contact_keys();

}  // namespace peristat
