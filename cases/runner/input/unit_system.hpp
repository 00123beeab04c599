#pragma once

#include <string>

#include "cases/runner/input/key_table.hpp"
#include "cases/runner/input/quantity.hpp"

namespace peristat {

/// Units of plain numbers and expressions: length, mass and time; all others follow from them.
struct UnitSystem {
  Unit length, mass, time;

  [[nodiscard]] bool is_si() const;
  /// The unit of a dimension; temperatures are in K, angles in the unit of their key.
  [[nodiscard]] Unit unit_of(const Dimension& dimension) const;
};

/// The units of a case. An unknown unit of force follows from the first that is given of stress,
/// energy and mass, whatever else is given must agree.
[[nodiscard]] UnitSystem unit_system(const UnitNames& names);

/// Table [units]. Its names must agree with one another.
[[nodiscard]] Table<UnitNames> unit_keys();

}  // namespace peristat
