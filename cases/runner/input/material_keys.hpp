#pragma once

#include <string>

#include "cases/runner/input/key_table.hpp"

namespace peristat {

/// The materials of the body, its regions and its interfaces.
/// @param name of the table: of the body, a region or an interface
[[nodiscard]] Table<MaterialSpecification> material_keys(const std::string& name);
[[nodiscard]] Table<RegionSpecification> region_keys();
[[nodiscard]] Table<InterfaceSpecification> interface_keys();

/// Checks that involve several materials. Without [material], the first region sets the model, the
/// plane and what else is common to the body.
void check_regions(const Entry& at, Case& result);

}  // namespace peristat
