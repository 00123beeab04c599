#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace peristat {

/// Calls visit(line, text) for the lines of a text file that are neither empty nor a comment (#),
/// without blanks around them; lines are counted from 1.
/// @throws InputError ("file") if the file can't be read
void for_each_row(const std::filesystem::path& file,
                  const std::function<void(std::size_t line, std::string_view text)>& visit);

/// Calls visit(line, text) for the first of these lines alone, if there is one.
void first_row(const std::filesystem::path& file,
               const std::function<void(std::size_t line, std::string_view text)>& visit);

/// The fields of a row, separated by commas or by blanks, without blanks around them.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);
[[nodiscard]] std::vector<std::string_view> split_at_blanks(std::string_view text);

/// A finite number; its decimals have a point, whatever the locale.
/// @param why_not gets the reason if it is none
[[nodiscard]] std::optional<double> number_in(std::string_view text, std::string& why_not);

}  // namespace peristat
