#pragma once

#include <optional>
#include <string_view>

namespace peristat {

/// A decimal number times 10^exponent, rounded once: "2.5" and -3 give the double 0.0025 to the
/// last bit, which 2.5 * 1e-3 need not. Decimals have a point, whatever the locale.
/// @param number a valid decimal number; `+` in front is allowed
/// @return nothing if the result is out of the range of normal and subnormal numbers
[[nodiscard]] std::optional<double> shifted_decimal(std::string_view number, int exponent);

/// The same with the precision of a long double.
[[nodiscard]] std::optional<long double> long_shifted_decimal(std::string_view number,
                                                              int exponent);

/// A length in a unit [m]; without a second rounding if the unit is a whole part of 1 m.
[[nodiscard]] double in_metres(double length, double unit);

}  // namespace peristat
