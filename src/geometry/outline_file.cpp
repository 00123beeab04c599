#include "src/geometry/outline_file.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "src/core/decimal.hpp"
#include "src/core/input_error.hpp"
#include "src/core/table_text.hpp"

namespace peristat {

std::vector<std::array<double, 2>> read_outline(const std::filesystem::path& file,
                                                double length_unit) {
  constexpr double largest = 1e30;  // as of every number in a case file
  std::vector<std::array<double, 2>> corners;
  constexpr std::size_t most_corners = 10'000;
  bool is_first = true;
  std::size_t closed_in = 0;  // line
  for_each_row(file, [&](std::size_t line, std::string_view text) {
    const auto refuse = [&](const std::string& why) {
      throw InputError("", "", why, file.string() + ":" + std::to_string(line));
    };
    const bool has_commas = text.find(',') != std::string_view::npos;
    const auto fields = has_commas ? split(text, ',') : split_at_blanks(text);
    const bool is_header = is_first && fields.size() == 2 && fields[0] == "x" && fields[1] == "y";
    is_first = false;
    if (is_header) return;
    if (fields.size() != 2)
      refuse("a corner has two numbers, x and y, not " + std::to_string(fields.size()));
    std::array<double, 2> corner{};
    for (std::size_t c = 0; c < 2; ++c) {
      std::string why_not;
      const std::optional<double> number = number_in(fields[c], why_not);
      const std::string shown = std::string(1, "xy"[c]) + " = '" + std::string(fields[c]) + "' ";
      if (!number) refuse(shown + why_not);
      if (std::abs(*number) > largest) refuse(shown + "is out of range");
      corner[c] = in_metres(*number, length_unit);
    }
    if (closed_in > 0)
      refuse("line " + std::to_string(closed_in) +
             " has closed the polygon by its first corner; a file has one polygon");
    if (corners.size() == most_corners)
      refuse("there are more than " + std::to_string(most_corners) +
             " corners, each of which is compared with every point; leave some out");
    if (!corners.empty() && corner == corners.front())
      closed_in = line;
    else
      corners.push_back(corner);
  });
  if (corners.size() < 3)
    throw InputError("file", file.string(), "a polygon needs at least three corners");
  return corners;
}

}  // namespace peristat
