#include "cases/runner/commands/key_reference.hpp"

#include <algorithm>
#include <cctype>
#include <vector>

#include <fmt/format.h>

#include "cases/runner/input/toml_table.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// N/m⁶ for N/m6
std::string raised(const std::string& unit) {
  static const std::vector<std::string> digits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text;
  const bool is_number = unit.find_first_not_of("0123456789") == std::string::npos;
  for (const char c : unit)
    text += is_number || !std::isdigit(c) ? std::string(1, c) : digits[std::size_t(c - '0')];
  return text;
}

/// `[solver]`, or `[[load]]` of an array.
std::string header(const TableDescription& table) {
  return table.is_array ? "`[[" + table.name + "]]`" : "`[" + table.name + "]`";
}

/// The table that a key of another one names; null if it has a value, which may be a table, too.
const TableDescription* table_of(const TableDescription& table, const KeyDescription& key) {
  if (!key.allowed.empty()) return nullptr;
  const std::string name = table.name.empty() ? key.name : table.name + "." + key.name;
  const auto found = std::ranges::find(table_descriptions(), name, &TableDescription::name);
  return found == table_descriptions().end() ? nullptr : &*found;
}

std::string shown_key(const TableDescription& table, const KeyDescription& key) {
  const TableDescription* const inner = table_of(table, key);
  return inner != nullptr ? header(*inner) : "`" + key.name + "`";
}

std::string shown_name(const TableDescription& table) {
  return table.name.empty() ? "document" : table.name;
}

}  // namespace

std::string key_reference(const TableDescription& table) {
  std::string rows = "| key | meaning | unit | default | allowed |\n|---|---|---|---|---|\n";
  for (const auto& key : table.keys) {
    rows += "| `" + key.name + "` |";
    for (const auto& cell :
         {key.meaning, raised(key.unit), key.fallback, short_exponents(key.allowed)})
      rows += cell.empty() ? " |" : " " + cell + " |";
    rows += "\n";
  }
  return rows;
}

Exit print_keys(const std::string& asked) {
  std::vector<std::string> names;
  std::string page;
  for (const auto& table : table_descriptions()) {
    if (!repeats_another(table.name)) names.push_back(shown_name(table));
    if (asked == shown_name(table) || (asked.empty() && names.back() == shown_name(table)))
      page += fmt::format("{}{}\n\n{}", page.empty() ? "" : "\n",
                          table.name.empty() ? "The document"
                          : table.is_array   ? "[[" + table.name + "]]"
                                             : "[" + table.name + "]",
                          key_reference(table));
  }
  if (page.empty())
    throw InputError("", asked,
                     "is not a table of a case file" + did_you_mean(asked, names) +
                         "  (tables: " + listed(names) + ")");
  fmt::print("{}", page);
  return Exit::done;
}

Exit print_keys_on_ranks() {
  std::string whole, parts;  // tables all of whose keys run there, and rows of the others
  for (const auto& table : table_descriptions()) {
    if (repeats_another(table.name)) continue;
    std::string row;
    for (const auto& key : table.keys) {
      if (!key.on_ranks) continue;
      std::string& list = table_of(table, key) != nullptr ? whole : row;
      list += (list.empty() ? "" : ", ") + shown_key(table, key);
    }
    if (row.empty()) continue;
    parts += fmt::format("| {} | {} |\n", table.name.empty() ? "" : header(table), row);
  }
  fmt::print("| table | keys |\n|---|---|\n{}| {} | all |\n", parts, whole);
  return Exit::done;
}

}  // namespace peristat
