#include "src/core/number_text.hpp"

#include <charconv>

namespace peristat {

std::string number_text(double value) {
  char text[32];  // the longest shortest double has 24 characters
  return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
}

std::string place_text(const Coordinates& place, int dimension) {
  std::string text;
  for (int c = 0; c < dimension; ++c) text += (c ? ", " : "(") + number_text(place[c]);
  return text + ")";
}

}  // namespace peristat
