#pragma once

#include <string>

namespace peristat {

/// Shortest TOML float that reads back as the same number ("5.0", "0.001", "1.92e+11", "inf").
[[nodiscard]] std::string toml_number(double value);

/// TOML basic string with its quotes; what needs it is escaped.
[[nodiscard]] std::string toml_string(const std::string& value);

}  // namespace peristat
