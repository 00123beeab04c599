#pragma once

#include <optional>
#include <string>

#include "cases/runner/input/unit_system.hpp"

namespace peristat {

/// Unit of the value of an expression: in SI units, and in those of the table [units].
struct UnitOfValue {
  Unit si, given;
};

/// An expression of a case file as an expression in SI units: its variables x, y, z, spacing and
/// horizon, which become lengths in m, are divided by the unit of length, the time t by that of
/// time, and the value is multiplied by its unit. Constants, and the factor in front of a product,
/// are converted themselves: "0.1*load" in mm becomes "0.0001*load", as does "0.1 mm*load".
/// @param of_value none: the value is a condition
/// @throws InputError without key and place if it has units that do not fit
[[nodiscard]] std::string in_si(const std::string& expression, const UnitSystem& units,
                                const std::optional<UnitOfValue>& of_value);

}  // namespace peristat
