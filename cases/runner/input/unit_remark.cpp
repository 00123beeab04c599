#include "cases/runner/input/unit_remark.hpp"

#include <cctype>
#include <charconv>

#include "src/core/number_text.hpp"

namespace peristat {
namespace {

/// Factor of an SI prefix in front of a unit; 0 if there is none.
double factor_of(const std::string& unit) {
  static constexpr const char* bases[] = {"Pa", "m", "N", "J"};
  static constexpr struct {
    const char* prefix;
    double factor;
  } prefixes[] = {{"", 1.0},   {"n", 1e-9}, {"u", 1e-6}, {"µ", 1e-6}, {"m", 1e-3},
                  {"c", 1e-2}, {"k", 1e3},  {"M", 1e6},  {"G", 1e9}};
  for (const char* base : bases) {
    for (const auto& [prefix, factor] : prefixes) {
      if (unit == prefix + std::string(base)) return factor;
    }
  }
  return 0.0;
}

}  // namespace

std::string remark_on_unit(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\"'+");
  if (begin == std::string::npos) return "";
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data() + begin, end, number);
  if (parsed.ec != std::errc()) return "";
  std::string unit;
  for (const char* c = parsed.ptr; c != end; ++c) {
    if (*c == '#' || *c == '\n' || *c == ',' || *c == ']' || *c == '}') break;
    if (*c != ' ' && *c != '\t' && *c != '\r' && *c != '"' && *c != '\'') unit += *c;
  }
  const auto first = static_cast<unsigned char>(unit.empty() ? '1' : unit[0]);
  const bool is_unit = unit.size() <= 12 && (std::isalpha(first) || first >= 0x80 || first == '%');
  if (!is_unit) return "";
  const double factor = factor_of(unit);
  return "; numbers carry no unit, all are in SI units" +
         (factor > 0.0 ? ": write " + number_text(number * factor) : "");
}

}  // namespace peristat
