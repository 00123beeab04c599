#include "cases/runner/input/quantity.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>

#include "src/core/decimal.hpp"

namespace peristat {
namespace {

struct Symbol {
  std::string_view name;
  Unit unit;
  bool takes_prefix = false;
};

namespace dimensions {
constexpr Dimension number{}, length{2}, mass{0, 2}, time{0, 0, 2}, frequency{0, 0, -2},
    force{2, 2, -4}, stress{-2, 2, -4}, energy{4, 2, -4}, temperature{0, 0, 0, 2},
    angle{0, 0, 0, 0, 2};
}  // namespace dimensions

constexpr long double one_degree = std::numbers::pi_v<long double> / 180.0L;
constexpr long double pound_force = 44482216152605.0L;  // 1e-13 N, exact
constexpr long double pound_per_inch2 = pound_force / (254.0L * 254.0L);

constexpr std::array unit_symbols{Symbol{"m", {dimensions::length}, true},
                                  Symbol{"g", {dimensions::mass, 1.0L, -6}, true},
                                  Symbol{"s", {dimensions::time}, true},
                                  Symbol{"N", {dimensions::force}, true},
                                  Symbol{"Pa", {dimensions::stress}, true},
                                  Symbol{"J", {dimensions::energy}, true},
                                  Symbol{"K", {dimensions::temperature}, true},
                                  Symbol{"Hz", {dimensions::frequency}, true},
                                  Symbol{"rad", {dimensions::angle}, true},
                                  Symbol{"deg", {dimensions::angle, one_degree}},
                                  Symbol{"degrees", {dimensions::angle, one_degree}},
                                  Symbol{"°", {dimensions::angle, one_degree}},
                                  Symbol{"%", {dimensions::number, 1.0L, -4}},
                                  Symbol{"t", {dimensions::mass, 1.0L, 6}},
                                  Symbol{"min", {dimensions::time, 6.0L, 2}},
                                  Symbol{"h", {dimensions::time, 36.0L, 4}},
                                  Symbol{"bar", {dimensions::stress, 1.0L, 10}},
                                  Symbol{"in", {dimensions::length, 254.0L, -8}},
                                  Symbol{"ft", {dimensions::length, 3048.0L, -8}},
                                  Symbol{"lbf", {dimensions::force, pound_force, -26}},
                                  Symbol{"psi", {dimensions::stress, pound_per_inch2, -10}},
                                  Symbol{"ksi", {dimensions::stress, pound_per_inch2, -4}}};

struct Prefix {
  std::string_view name;
  int tens;
};
/// Both Greek letters mu of Unicode are in use.
constexpr std::array unit_prefixes{Prefix{"n", -9}, Prefix{"u", -6}, Prefix{"µ", -6},
                                   Prefix{"μ", -6}, Prefix{"m", -3}, Prefix{"c", -2},
                                   Prefix{"d", -1}, Prefix{"k", 3},  Prefix{"M", 6},
                                   Prefix{"G", 9},  Prefix{"T", 12}};

std::optional<Unit> unit_of_symbol(std::string_view name) {
  for (const Symbol& symbol : unit_symbols)
    if (name == symbol.name) return symbol.unit;
  for (const Symbol& symbol : unit_symbols) {
    if (!symbol.takes_prefix || !name.ends_with(symbol.name)) continue;
    const std::string_view front = name.substr(0, name.size() - symbol.name.size());
    for (const Prefix& prefix : unit_prefixes) {
      if (front != prefix.name) continue;
      Unit unit = symbol.unit;
      unit.half_tens += 2 * prefix.tens;
      return unit;
    }
  }
  return std::nullopt;
}

bool differs_in_case_alone(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char one, char other) {
    return std::tolower(static_cast<unsigned char>(one)) ==
           std::tolower(static_cast<unsigned char>(other));
  });
}

/// "; did you mean MPa?" for "mpa", or nothing.
std::string meant_symbol(std::string_view name) {
  std::string meant;
  const auto compare = [&](const std::string& known) {
    if (differs_in_case_alone(name, known)) meant += (meant.empty() ? "" : " or ") + known;
  };
  for (const Symbol& symbol : unit_symbols) {
    compare(std::string(symbol.name));
    if (!symbol.takes_prefix) continue;
    for (const Prefix& prefix : unit_prefixes)
      compare(std::string(prefix.name) + std::string(symbol.name));
  }
  return meant.empty() ? "" : "; did you mean " + meant + "?";
}

/// Reads a unit from left to right; * and / have the same rank.
class UnitReader {
 public:
  explicit UnitReader(std::string_view text) : text_(text) {}

  std::optional<Unit> whole(std::string& why_not) {
    constexpr std::size_t longest = 60;
    std::optional<Unit> unit;
    if (text_.size() <= longest) unit = product();
    if (unit && at_ == text_.size()) return unit;
    why_not = why_not_.empty() ? "\"" + std::string(text_.substr(0, longest)) + "\" is no unit"
                               : why_not_;
    return std::nullopt;
  }

 private:
  bool take(std::string_view token) {
    if (!text_.substr(at_).starts_with(token)) return false;
    at_ += token.size();
    return true;
  }
  void skip_blanks() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }

  std::optional<Unit> product() {
    skip_blanks();
    std::optional<Unit> unit = text_.substr(at_).starts_with("1/") ? Unit() : factor();
    if (unit && unit->dimension == dimensions::number && text_.substr(at_).starts_with("1/")) ++at_;
    while (unit) {
      const std::size_t before = at_;
      skip_blanks();
      const bool is_root =
          text_.substr(at_).starts_with("sqrt(") || text_.substr(at_).starts_with("√");
      const bool divides = take("/");
      if (!divides && !take("*") && !take("·") && !is_root) {
        at_ = before;
        return unit;
      }
      skip_blanks();
      const std::optional<Unit> next = factor();
      if (!next) return std::nullopt;
      unit = divides ? *unit / *next : *unit * *next;
    }
    return unit;
  }

  std::optional<Unit> factor() {
    if (take("√")) return root(take("(") ? closed(product()) : symbol());
    if (take("sqrt(")) return root(closed(product()));
    return raised(take("(") ? closed(product()) : symbol());
  }

  std::optional<Unit> closed(const std::optional<Unit>& inside) {
    skip_blanks();
    return take(")") ? inside : std::nullopt;
  }

  static std::optional<Unit> root(const std::optional<Unit>& unit) {
    if (!unit || unit->half_tens % 2 != 0) return std::nullopt;
    for (const int exponent : unit->dimension)
      if (exponent % 2 != 0) return std::nullopt;
    return unit->power(1);
  }

  std::optional<Unit> symbol() {
    const std::size_t begin = at_;
    const auto belongs = [](char c) {
      return std::isalpha(static_cast<unsigned char>(c)) || c == '%';
    };
    while (at_ < text_.size()) {
      if (belongs(text_[at_]))
        ++at_;
      else if (!take("µ") && !take("μ") && !take("°"))
        break;
    }
    const std::string_view name = text_.substr(begin, at_ - begin);
    const std::optional<Unit> unit = unit_of_symbol(name);
    if (!unit && !name.empty())
      why_not_ = "there is no unit \"" + std::string(name) + "\"" + meant_symbol(name);
    return unit;
  }

  /// Digits, at most two; nothing without one.
  std::optional<int> small_number() {
    int number = 0;
    std::size_t end = at_;
    while (end < text_.size() && end < at_ + 2 && text_[end] >= '0' && text_[end] <= '9')
      number = 10 * number + (text_[end++] - '0');
    if (end == at_) return std::nullopt;
    at_ = end;
    return number;
  }

  /// False for exponents that are never meant, whose powers could overflow.
  static bool is_moderate(const Unit& unit) {
    constexpr int largest = 200;
    return std::abs(unit.half_tens) <= 10 * largest &&
           std::ranges::all_of(unit.dimension, [](int e) { return std::abs(e) <= largest; });
  }

  /// Applies an exponent, if there is one.
  std::optional<Unit> raised(const std::optional<Unit>& unit) {
    if (!unit) return unit;
    if (take("²")) return unit->power(4);
    if (take("³")) return unit->power(6);
    const bool is_marked = take("^");
    const bool is_closed = is_marked && take("(");
    const int sign = take("-") ? -1 : 1;
    const std::optional<int> number = small_number();
    if (!number) return is_marked || sign < 0 ? std::nullopt : unit;
    int halves = 2 * *number;
    if (is_marked && take(".5"))
      halves += 1;
    else if (is_closed && take("/2"))
      halves = *number;
    if (is_closed && !take(")")) return std::nullopt;
    const bool is_half = halves % 2 != 0;
    if (is_half && std::ranges::any_of(unit->dimension, [](int e) { return e % 2 != 0; }))
      return std::nullopt;
    const Unit power = unit->power(sign * halves);
    return is_moderate(power) ? std::optional(power) : std::nullopt;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::string why_not_;
};

struct Named {
  const char* unit;
  const char* name;
  const char* example;
};
constexpr std::array named_dimensions{
    Named{"1", "a number without a unit", "0.25"},
    Named{"m", "a length", "2.5 mm"},
    Named{"m2", "an area", "4 mm2"},
    Named{"m3", "a volume", "4 mm3"},
    Named{"s", "a time", "20 us"},
    Named{"1/s", "a rate", "50 1/s"},
    Named{"m/s", "a velocity", "5 mm/s"},
    Named{"m/s2", "an acceleration", "9.81 m/s2"},
    Named{"kg", "a mass", "5 g"},
    Named{"kg/m3", "a density", "2.4 t/m3"},
    Named{"N", "a force", "5 kN"},
    Named{"N/m", "an energy per area or force per length", "110 N/m"},
    Named{"N/m3", "a force per volume", "25 kN/m3"},
    Named{"Pa", "a stress", "210 GPa"},
    Named{"J", "an energy", "5 mJ"},
    Named{"Pa*sqrt(m)", "a toughness", "30 MPa*sqrt(m)"},
    Named{"K", "a difference of temperature", "20 K"},
    Named{"1/K", "a thermal expansion", "12e-6 1/K"},
    Named{"rad", "an angle", "30 deg"}};

const Named* named(const Dimension& dimension) {
  const auto found = std::ranges::find_if(named_dimensions, [&](const Named& entry) {
    return unit_of_key(entry.unit).dimension == dimension;
  });
  return found == named_dimensions.end() ? nullptr : &*found;
}

}  // namespace

double Unit::size() const {
  const long double tens = half_tens / 2, rest = half_tens % 2;
  return static_cast<double>(factor * std::pow(10.0L, tens) * std::pow(10.0L, rest / 2.0L));
}

Unit Unit::power(int halves) const {
  Unit result;
  for (std::size_t k = 0; k < dimension.size(); ++k)
    result.dimension[k] = dimension[k] * halves / 2;
  result.factor = factor == 1.0L ? 1.0L : std::pow(factor, halves / 2.0L);
  result.half_tens = half_tens * halves / 2;
  return result;
}

bool Unit::has_size_of(const Unit& other) const {
  constexpr long double round_off = 1e-15L;
  return half_tens == other.half_tens && std::abs(factor / other.factor - 1.0L) < round_off;
}

Unit operator*(const Unit& a, const Unit& b) {
  Unit product{a.dimension, a.factor * b.factor, a.half_tens + b.half_tens};
  for (std::size_t k = 0; k < b.dimension.size(); ++k) product.dimension[k] += b.dimension[k];
  return product;
}

Unit operator/(const Unit& a, const Unit& b) {
  Unit quotient{a.dimension, a.factor / b.factor, a.half_tens - b.half_tens};
  for (std::size_t k = 0; k < b.dimension.size(); ++k) quotient.dimension[k] -= b.dimension[k];
  return quotient;
}

std::optional<Unit> parse_unit(std::string_view text, std::string& why_not) {
  return UnitReader(text).whole(why_not);
}

Unit unit_of_key(const std::string& unit) {
  if (unit == "1") return {};
  std::string why_not;
  const std::optional<Unit> parsed = parse_unit(unit, why_not);
  if (!parsed) throw std::logic_error("a key has the unit " + unit + ": " + why_not);
  return *parsed;
}

bool is_unit_of_measure(const std::string& unit) {
  std::string why_not;
  return unit == "1" || (!unit.empty() && parse_unit(unit, why_not));
}

std::size_t length_of_number(std::string_view text) {
  const std::size_t sign = text.starts_with('+') || text.starts_with('-') ? 1 : 0;
  const auto is_digit = [&](std::size_t at) {
    return at < text.size() && text[at] >= '0' && text[at] <= '9';
  };
  std::size_t end = sign, digits = 0;
  for (; is_digit(end); ++end) ++digits;
  if (end < text.size() && text[end] == '.')
    for (++end; is_digit(end); ++end) ++digits;
  if (digits == 0) return 0;
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    const bool is_signed = end + 1 < text.size() && (text[end + 1] == '+' || text[end + 1] == '-');
    std::size_t last = end + 1 + (is_signed ? 1 : 0);
    if (is_digit(last)) {
      while (is_digit(last)) ++last;
      end = last;
    }
  }
  return end;
}

std::optional<double> in_unit(std::string_view number, const Unit& unit) {
  const int half = unit.half_tens % 2, tens = (unit.half_tens - half) / 2;
  if (half == 0 && unit.factor == 1.0L) return shifted_decimal(number, tens);
  const std::optional<long double> shifted = long_shifted_decimal(number, tens);
  if (!shifted) return std::nullopt;
  const auto value = static_cast<double>(*shifted * unit.factor * std::pow(10.0L, half / 2.0L));
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::string words_for(const Unit& unit, const std::string& name) {
  const Named* const known = named(unit.dimension);
  return known == nullptr ? "a number in " + name
                          : std::string(known->name) + ", e.g. " + known->example;
}

std::string name_of(const Dimension& dimension) {
  const Named* const known = named(dimension);
  return known == nullptr ? "" : known->name;
}

}  // namespace peristat
