#include "cases/runner/commands/key_reference.hpp"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>
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

/// Where the next `"value"`: of a meaning begins, and where the words on it do.
struct ValueMark {
  std::size_t begin = std::string::npos, words = std::string::npos;
};

ValueMark next_value(const std::string& meaning, std::size_t from) {
  while ((from = meaning.find("`\"", from)) != std::string::npos) {
    const std::size_t end =
        meaning.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_", from + 2);
    if (end != std::string::npos && meaning.compare(end, 4, "\"`: ") == 0) return {from, end + 4};
    from += 2;
  }
  return {};
}

/// Where the first sentence from a place on ends; the next one begins with a capital or a key. "St.
/// Venant" is no end.
std::size_t end_of_sentence(const std::string& text, std::size_t from) {
  for (; (from = text.find(". ", from)) != std::string::npos; ++from) {
    const char next = from + 2 < text.size() ? text[from + 2] : ' ';
    const bool begins = std::isupper(static_cast<unsigned char>(next)) || next == '`';
    if (begins && text.compare(from - 2, 2, "St") != 0) return from;
  }
  return text.size();
}

std::string trimmed(std::string text) {
  text.erase(text.find_last_not_of(" .;:") + 1);
  text.erase(0, text.find_first_not_of(" .;"));
  return text;
}

/// A meaning of the form `words. "a": …; "b": …. More words` by parts: what holds for the key, and
/// what each value means.
struct PartsOfMeaning {
  std::string words;
  std::vector<std::pair<std::string, std::string>> values;  ///< `"a"` and its meaning
};

PartsOfMeaning parts_of(const std::string& meaning) {
  PartsOfMeaning parts;
  ValueMark at = next_value(meaning, 0);
  if (next_value(meaning, at.words).begin == std::string::npos) return {meaning, {}};
  parts.words = trimmed(meaning.substr(0, at.begin));
  while (at.begin != std::string::npos) {
    const ValueMark next = next_value(meaning, at.words);
    const std::size_t end =
        next.begin != std::string::npos ? next.begin : end_of_sentence(meaning, at.words);
    parts.values.emplace_back(meaning.substr(at.begin + 1, at.words - at.begin - 4),
                              trimmed(meaning.substr(at.words, end - at.words)));
    const std::string rest = next.begin != std::string::npos ? "" : trimmed(meaning.substr(end));
    if (!rest.empty()) parts.words += (parts.words.empty() ? "" : ". ") + rest;
    at = next;
  }
  if (parts.words.empty()) parts.words = "one of the values below";
  return parts;
}

}  // namespace

std::string key_reference(const TableDescription& table) {
  std::string rows = "| key | meaning | unit | default | allowed |\n|---|---|---|---|---|\n";
  for (const auto& key : table.keys) {
    const PartsOfMeaning meaning = parts_of(key.meaning);
    rows += "| `" + key.name + "` |";
    for (const auto& cell :
         {meaning.words, raised(key.unit), key.fallback, short_exponents(key.allowed)})
      rows += cell.empty() ? " |" : " " + cell + " |";
    rows += "\n";
    for (const auto& [value, words] : meaning.values)
      rows += fmt::format("| `{} = {}` | {} | | | |\n", key.name, value, words);
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
