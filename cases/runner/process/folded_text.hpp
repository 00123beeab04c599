#pragma once

#include <cstddef>
#include <string>

namespace peristat {

/// A line broken at spaces into lines of at most `width` columns, where words allow; the further
/// lines are indented by four columns more than the first. Every code point counts as a column.
[[nodiscard]] std::string folded(const std::string& line, std::size_t width);

/// Its first code points up to a width.
[[nodiscard]] std::string cut_to(const std::string& line, std::size_t width);

}  // namespace peristat
