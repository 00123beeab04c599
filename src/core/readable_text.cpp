#include "src/core/readable_text.hpp"

#include <cstdio>
#include <string_view>

namespace peristat {
namespace {

/// Bytes of the UTF-8 code point at the front of a text that is not empty; 0 if there is none.
std::size_t length_of_code_point(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xC2 && first < 0xE0 ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  return length;
}

std::string escaped(const char* format, unsigned number) {
  char text[8];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

/// A code point as it is, or escaped if it is a control character (C0, DEL, C1).
std::string shown(std::string_view code_point) {
  const auto first = static_cast<unsigned char>(code_point[0]);
  if (code_point == "\n") return "\\n";
  if (code_point == "\t") return "\\t";
  if (first < 0x20 || first == 0x7F) return escaped("\\u%04X", first);
  if (first == 0xC2 && static_cast<unsigned char>(code_point[1]) < 0xA0) {
    return escaped("\\u%04X", static_cast<unsigned char>(code_point[1]));
  }
  return std::string(code_point);
}

}  // namespace

std::string readable(const std::string& text, std::size_t most) {
  std::string result;
  std::size_t characters = 0;
  for (std::size_t i = 0; i < text.size(); ++characters) {
    const std::size_t length = length_of_code_point(std::string_view(text).substr(i));
    if (characters < most) {
      result += length == 0 ? escaped("\\x%02X", static_cast<unsigned char>(text[i]))
                            : shown(std::string_view(text).substr(i, length));
    }
    i += length == 0 ? 1 : length;
  }
  if (characters > most) result += "… (" + std::to_string(characters) + " characters)";
  return result;
}

}  // namespace peristat
