#pragma once

#include <cstddef>
#include <string>

namespace peristat {

/// A text that somebody else wrote, fit to be quoted in a message: characters that would not be
/// seen, end the message or steer a terminal are escaped (\n, \u0000, \xFF for a byte that is no
/// UTF-8), and of a text that has more than `most` characters its first ones are followed by
/// "… (N characters)".
[[nodiscard]] std::string readable(const std::string& text, std::size_t most);

}  // namespace peristat
