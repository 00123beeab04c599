#include "cases/runner/input/toml_text.hpp"

#include <cstdio>

#include "src/core/number_text.hpp"

namespace peristat {

std::string toml_number(double value) {
  std::string number = number_text(value);
  // "5" would be a TOML integer
  if (number.find_first_not_of("-0123456789") == std::string::npos) number += ".0";
  return number;
}

std::string toml_string(const std::string& value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04X", static_cast<unsigned>(c));
      text += escaped;
    } else {
      text += c;
    }
  }
  return text + '"';
}

}  // namespace peristat
