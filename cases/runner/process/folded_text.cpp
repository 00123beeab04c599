#include "cases/runner/process/folded_text.hpp"

#include <algorithm>

namespace peristat {
namespace {

bool begins_code_point(char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }

}  // namespace

std::string cut_to(const std::string& line, std::size_t width) {
  std::size_t columns = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (begins_code_point(line[i]) && columns++ == width) return line.substr(0, i);
  }
  return line;
}

std::string folded(const std::string& line, std::size_t width) {
  std::string result, rest = line;
  const std::size_t own = std::min(line.find_first_not_of(' '), line.size());
  const std::string indentation(own + 4, ' ');
  while (cut_to(rest, width) != rest) {
    const std::size_t most = cut_to(rest, width + 1).size() - 1;  // a space may follow the width
    std::size_t end = rest.rfind(' ', most);
    const std::size_t first = rest.find_first_not_of(' ');
    // a word longer than the width stays whole
    if (end == std::string::npos || end < first) end = rest.find(' ', first);
    if (end == std::string::npos) break;
    const std::size_t next = rest.find_first_not_of(' ', end);
    if (next == std::string::npos) break;
    result += rest.substr(0, rest.find_last_not_of(' ', end) + 1) + '\n';
    rest = indentation + rest.substr(next);
  }
  return result + rest;
}

}  // namespace peristat
