#pragma once

#include <cstddef>
#include <string>

namespace peristat {

/// Text from outside, made fit to be quoted in a message: characters that are invisible, end the
/// message or steer a terminal are escaped (\n, \u0000, \xFF for a byte that is not UTF-8). A text
/// of more than `most` characters is cut after these and followed by "… (N characters)".
[[nodiscard]] std::string readable(const std::string& text, std::size_t most);

}  // namespace peristat
