#pragma once

#include "cases/runner/input/key_table.hpp"

namespace peristat {

/// The points of the body, sets of them, and cracks between them.
[[nodiscard]] Table<Case> lattice_keys();
[[nodiscard]] Table<Case> points_keys();
[[nodiscard]] Table<SetRule> set_keys();
[[nodiscard]] Table<Crack> crack_keys();

/// Corrections of the weights.
[[nodiscard]] Table<Case> quadrature_keys();

/// Refuses keys of the quadrature that the model of the material, which is read later, does not
/// use.
void check_quadrature(const Entry& at, const Case& result);

}  // namespace peristat
