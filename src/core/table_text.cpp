#include "src/core/table_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

}  // namespace

namespace {

/// Visits rows until a visit returns false.
void visit_rows(const std::filesystem::path& file,
                const std::function<bool(std::size_t, std::string_view)>& visit) {
  std::ifstream stream(file);
  if (std::filesystem::is_directory(file) || !stream)
    throw InputError("file", file.string(), "the file can't be read");
  std::size_t number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    std::string_view text = line;
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    if (number == 1 && text.starts_with(byte_order_mark)) text.remove_prefix(3);
    text = trimmed(text);
    if (!text.empty() && text.front() != '#' && !visit(number, text)) return;
  }
  if (stream.bad()) throw InputError("file", file.string(), "the file can't be read to its end");
}

}  // namespace

void for_each_row(const std::filesystem::path& file,
                  const std::function<void(std::size_t, std::string_view)>& visit) {
  visit_rows(file, [&](std::size_t line, std::string_view text) {
    visit(line, text);
    return true;
  });
}

void first_row(const std::filesystem::path& file,
               const std::function<void(std::size_t, std::string_view)>& visit) {
  visit_rows(file, [&](std::size_t line, std::string_view text) {
    visit(line, text);
    return false;
  });
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> fields;
  for (std::size_t end; (end = text.find(separator)) != std::string_view::npos;) {
    fields.push_back(trimmed(text.substr(0, end)));
    text.remove_prefix(end + 1);
  }
  fields.push_back(trimmed(text));
  return fields;
}

std::vector<std::string_view> split_at_blanks(std::string_view text) {
  std::vector<std::string_view> fields;
  while (!(text = trimmed(text)).empty()) {
    const std::size_t end = std::min(text.find_first_of(blanks), text.size());
    fields.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return fields;
}

std::optional<double> number_in(std::string_view text, std::string& why_not) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_whole = error == std::errc() && end == text.data() + text.size();
  if (error == std::errc::result_out_of_range)
    why_not = "is out of range";
  else if (!is_whole)
    why_not = "is not a number";
  else if (!std::isfinite(value))
    why_not = "is not finite";
  else
    return value;
  return std::nullopt;
}

}  // namespace peristat
