#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace peristat {

/// Twice the exponents of length, mass, time, temperature and angle: a toughness has halves.
using Dimension = std::array<int, 5>;

/// A unit of measure: its dimension, and its size in the units m, kg, s, K and rad, which is
/// factor 10^(half_tens / 2). The power of ten stays apart from the factor so that numbers are
/// converted without rounding twice.
struct Unit {
  Dimension dimension{};
  long double factor = 1.0L;
  int half_tens = 0;

  [[nodiscard]] double size() const;
  /// The unit to the power of halves / 2.
  [[nodiscard]] Unit power(int halves) const;
  [[nodiscard]] bool has_size_of(const Unit& other) const;
};
[[nodiscard]] Unit operator*(const Unit& a, const Unit& b);
[[nodiscard]] Unit operator/(const Unit& a, const Unit& b);

/// Parses a unit: symbols with prefixes ("mm", "GPa"), joined by * and /, with exponents ("kg/m3",
/// "N/mm^2", "1/K") and roots ("MPa*sqrt(m)", "MPa√m", "N/mm^1.5").
/// @param why_not gets the reason if it is none
[[nodiscard]] std::optional<Unit> parse_unit(std::string_view text, std::string& why_not);

/// The unit of a key of the case file. @throws std::logic_error if it is none
[[nodiscard]] Unit unit_of_key(const std::string& unit);

/// True if the unit of a key is a dimension or "1", not a count such as "spacings".
[[nodiscard]] bool is_unit_of_measure(const std::string& unit);

/// Length of the decimal number that the text begins with; 0 if there is none ("nan", "x").
[[nodiscard]] std::size_t length_of_number(std::string_view text);

/// A decimal number times a unit's size: the double nearest to the product if that is a power of
/// ten, so that "2.5" in mm is 0.0025 to the last bit.
/// @return nothing if it is out of the range of doubles
[[nodiscard]] std::optional<double> in_unit(std::string_view number, const Unit& unit);

/// "a length, e.g. 2.5 mm"
[[nodiscard]] std::string words_for(const Unit& unit, const std::string& name);

/// "a length"; empty for a dimension without a name.
[[nodiscard]] std::string name_of(const Dimension& dimension);

}  // namespace peristat
