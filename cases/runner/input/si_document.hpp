#pragma once

#include <string>

#include "cases/runner/input/toml_value.hpp"
#include "cases/runner/input/unit_system.hpp"

namespace peristat {

/// Converts the values of a case file to SI units: plain numbers and expressions from the units of
/// the table [units], strings such as "2.5 mm" from their own. They keep the text as written.
/// Values of a wrong kind are left to the reader, which refuses them.
/// @throws InputError with key and place if the dimension of a unit is not that of the key
void convert_to_si(TomlValue& document, const UnitSystem& units, const std::string& file);

}  // namespace peristat
