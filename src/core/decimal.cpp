#include "src/core/decimal.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>
#include <system_error>

namespace peristat {
namespace {

template <class Number>
std::optional<Number> shifted(std::string_view number, int exponent) {
  if (number.starts_with('+')) number.remove_prefix(1);
  const std::size_t mantissa = std::min(number.find_first_of("eE"), number.size());
  int own = 0;
  if (mantissa < number.size()) {
    std::string_view digits = number.substr(mantissa + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    constexpr int remote = 100'000;  // no sum of two such exponents overflows
    const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), own);
    if (parsed.ec != std::errc() || std::abs(own) > remote) return std::nullopt;
  }
  const std::string text =
      std::string(number.substr(0, mantissa)) + "e" + std::to_string(own + exponent);
  Number value{};
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> shifted_decimal(std::string_view number, int exponent) {
  return shifted<double>(number, exponent);
}

std::optional<long double> long_shifted_decimal(std::string_view number, int exponent) {
  return shifted<long double>(number, exponent);
}

double in_metres(double length, double unit) {
  const double parts = std::round(1.0 / unit);
  return unit < 1.0 && 1.0 / parts == unit ? length / parts : length * unit;
}

}  // namespace peristat
