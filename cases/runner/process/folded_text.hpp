#pragma once

#include <cstddef>
#include <string>

namespace peristat {

/// Breaks a line at spaces into lines of at most `width` columns; a longer word stays whole.
/// Further lines are indented by four columns more than the first. Every code point counts as a
/// column.
[[nodiscard]] std::string folded(const std::string& line, std::size_t width);

/// Cuts a line to its first `width` code points.
[[nodiscard]] std::string cut_to(const std::string& line, std::size_t width);

}  // namespace peristat
