#include "cases/runner/input/toml_value.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

// toml++ 3.3 asserts that "[[[" does not occur, and reports it well if the assertion is not there.
#define TOML_ASSERT(condition) static_assert(true)
// Largest depth of nested values; a case needs 4. This limit and deepest_key keep recursions from
// overflowing the stack.
#define TOML_MAX_NESTED_VALUES 16
#include <toml++/toml.h>

#include "cases/runner/input/quantity.hpp"
#include "src/core/input_error.hpp"
#include "src/core/readable_text.hpp"

namespace peristat {
namespace {

/// Parts of a dotted key; a case needs 3. toml++ has no limit and overflows the stack.
constexpr std::size_t deepest_key = 16;

/// Characters of an override that are quoted as a place.
constexpr std::size_t most_of_override = 200;

[[noreturn]] void refuse_deep_key(const CaseLocation& location, const std::string& file) {
  throw InputError("", "",
                   "a key of more than " + std::to_string(deepest_key) +
                       " parts; no key of a case file is that deep",
                   location.text(file));
}

/// Looks for dotted keys that are too deep, outside strings and comments.
void check_depth_of_keys(std::string_view text, const std::string& file) {
  int line = 1;
  std::size_t dots = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (c == '"' || c == '\'') {
      const bool is_long = text.substr(i, 3) == std::string(3, c);
      const std::string_view end = text.substr(i, is_long ? 3 : 1);
      for (i += end.size(); i < text.size() && text.substr(i, end.size()) != end; ++i) {
        if (text[i] == '\n' && !is_long) break;
        if (text[i] == '\\' && c == '"') ++i;
        if (i < text.size() && text[i] == '\n') ++line;
      }
      const bool is_unfinished = i < text.size() && text[i] == '\n' && !is_long;
      i = is_unfinished ? i - 1 : i + end.size() - 1;  // the next turn takes the line's end
    } else if (c == '.') {
      if (++dots >= deepest_key) refuse_deep_key({line, 1, {}}, file);
    } else if (c == '\n' || std::string_view("=,[]{}").find(c) != std::string_view::npos) {
      dots = 0;
      if (c == '\n') ++line;
    }
  }
}

/// Lines of a text, with the text of one-line regions. Columns count code points from 1, as toml++
/// does. The first bytes of a line's code points are found once, at the first query.
class Lines {
 public:
  explicit Lines(std::string_view text) {
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      lines_.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
    code_points_.resize(lines_.size());
  }

  /// Text behind the first '=' of a line.
  std::string value_in(toml::source_index line) const {
    if (line == 0 || line > lines_.size()) return {};
    const std::size_t equals = lines_[line - 1].find('=');
    return equals == std::string_view::npos ? "" : std::string(lines_[line - 1].substr(equals + 1));
  }

  std::string region(const toml::source_region& region) const {
    const auto line = region.begin.line;
    if (line == 0 || line != region.end.line || line > lines_.size()) return {};
    const std::string_view text = lines_[line - 1];
    std::vector<std::uint32_t>& begins = code_points_[line - 1];
    if (begins.empty()) begins = beginnings(text);
    const auto byte = [&](toml::source_index column) {
      return column > begins.size() ? text.size() : std::size_t(begins[std::max(column, 1u) - 1]);
    };
    const std::size_t begin = byte(region.begin.column), end = byte(region.end.column);
    return std::string(text.substr(begin, end > begin ? end - begin : 0));
  }

 private:
  static std::vector<std::uint32_t> beginnings(std::string_view line) {
    std::vector<std::uint32_t> begins;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const bool continues_code_point = (static_cast<unsigned char>(line[i]) & 0xC0) == 0x80;
      if (!continues_code_point) begins.push_back(static_cast<std::uint32_t>(i));
    }
    return begins;
  }

  std::vector<std::string_view> lines_;
  mutable std::vector<std::vector<std::uint32_t>> code_points_;  // first bytes, per line
};

/// "; write … in quotes" if the text is a number with a unit behind it (5 mm), which is no TOML.
std::string remark_on_quotes(std::string text) {
  text = text.substr(0, text.find_first_of("#\r\n"));
  while (text.starts_with(' ')) text.erase(0, 1);
  while (text.ends_with(' ')) text.pop_back();
  const std::size_t number = length_of_number(text);
  std::string why_not;
  if (number == 0 || !parse_unit(std::string_view(text).substr(number), why_not)) return "";
  return "; write a number with a unit in quotes: \"" + text + "\"";
}

CaseLocation at(const toml::source_region& region) {
  return {static_cast<int>(region.begin.line), static_cast<int>(region.begin.column), {}};
}

TomlValue convert(const toml::node& node, const CaseLocation& location, const Lines& lines) {
  using Kind = TomlValue::Kind;
  TomlValue value;
  value.location = location;
  if (!node.is_table()) value.written = lines.region(node.source());
  if (const auto* table = node.as_table()) {
    value.kind = Kind::table;
    for (const auto& [key, entry] : *table) {
      // a table's header begins before the key in it, a value after its key
      const auto& source =
          entry.source().begin < key.source().begin ? entry.source() : key.source();
      value.entries.emplace(std::string(key.str()), convert(entry, at(source), lines));
    }
  } else if (const auto* array = node.as_array()) {
    value.kind = Kind::array;
    for (const auto& item : *array) value.items.push_back(convert(item, at(item.source()), lines));
  } else if (const auto* boolean = node.as_boolean()) {
    value.kind = Kind::boolean;
    value.boolean = boolean->get();
  } else if (const auto* integer = node.as_integer()) {
    value.kind = Kind::integer;
    value.integer = integer->get();
  } else if (const auto* real = node.as_floating_point()) {
    value.kind = Kind::real;
    value.real = real->get();
  } else if (const auto* string = node.as_string()) {
    value.kind = Kind::string;
    value.string = string->get();
  } else {
    value.kind = Kind::date;
  }
  return value;
}

/// Marks a value and everything in it as coming from an override.
void mark(TomlValue& value, const std::string& override_text) {
  value.location = {0, 0, override_text};
  for (auto& item : value.items) mark(item, override_text);
  for (auto& [key, entry] : value.entries) mark(entry, override_text);
}

TomlValue override_value(const std::string& text) {
  try {
    TomlValue document = parse_toml("value = " + text, "");
    if (document.entries.size() == 1) return std::move(document.entries.begin()->second);
  } catch (const InputError&) {
    // not TOML, so it is a string, as documented
  }
  TomlValue value;
  value.kind = TomlValue::Kind::string;
  value.string = value.written = text;
  return value;
}

/// One part of a dotted key: name[index][index]…
struct KeyPart {
  std::string name;
  std::vector<std::size_t> indices;
};

/// The parts of a dotted key; none if it has another form.
std::vector<KeyPart> split_key(const std::string& key) {
  std::vector<KeyPart> parts(1);
  const char* const end = key.data() + key.size();
  for (const char* c = key.data(); c != end;) {
    KeyPart& part = parts.back();
    if (*c == '.') {
      if (part.name.empty()) return {};
      parts.emplace_back();
      ++c;
    } else if (*c == '[') {
      std::size_t index = 0;
      const auto number = std::from_chars(c + 1, end, index);
      if (part.name.empty() || number.ec != std::errc() || number.ptr == end || *number.ptr != ']')
        return {};
      part.indices.push_back(index);
      c = number.ptr + 1;
    } else {
      if (!part.indices.empty() || *c == ' ' || *c == ']') return {};
      part.name += *c++;
    }
  }
  if (parts.back().name.empty()) return {};
  return parts;
}

}  // namespace

bool TomlValue::is_array_of_tables() const {
  return kind == Kind::array && !items.empty() &&
         std::all_of(items.begin(), items.end(), [](const auto& item) { return item.is_table(); });
}

std::string kind_name(const TomlValue& value) {
  switch (value.kind) {
    case TomlValue::Kind::boolean:
      return "a boolean";
    case TomlValue::Kind::integer:
      return "a whole number";
    case TomlValue::Kind::real:
      return "a number";
    case TomlValue::Kind::string:
      return "a string";
    case TomlValue::Kind::date:
      return "a date or time";
    case TomlValue::Kind::array:
      return value.is_array_of_tables() ? "an array of tables" : "an array";
    case TomlValue::Kind::table:
      return "a table";
  }
  return {};
}

TomlValue parse_toml(const std::string& text, const std::string& file) {
  check_depth_of_keys(text, file);
  try {
    const toml::table document = toml::parse(std::string_view(text));
    return convert(document, {1, 1, {}}, Lines(text));
  } catch (const toml::parse_error& error) {
    const Lines lines(text);
    throw InputError("", "",
                     "not valid TOML: " + std::string(error.description()) +
                         remark_on_quotes(lines.value_in(error.source().begin.line)),
                     at(error.source()).text(file));
  }
}

void apply_override(TomlValue& document, const std::string& key, const std::string& value) {
  // Every value that the override sets keeps a copy of this text as its place.
  const std::string text = readable(key + "=" + value, most_of_override);
  const auto refuse = [&](const std::string& why) {
    throw InputError(key, value, why, "--set " + text);
  };
  const auto parts = split_key(key);
  std::size_t depth = parts.size();
  for (const auto& part : parts) depth += part.indices.size();
  if (depth > deepest_key) refuse_deep_key({0, 0, text}, "");
  if (parts.empty())
    refuse("not a key; allowed are dotted keys such as loading.steps or support[0].displacement");

  TomlValue* at = &document;
  std::string path;
  for (const auto& part : parts) {
    if (at->kind == TomlValue::Kind::array) {
      refuse(path + " is an array" +
             (at->items.empty() ? ""
                                : "; name one of it: " + path + "[0] to " + path + "[" +
                                      std::to_string(at->items.size() - 1) + "]"));
    }
    if (!at->is_table()) refuse(path + " is " + kind_name(*at) + ", which has no keys");
    path += (path.empty() ? "" : ".") + part.name;
    const auto [entry, made] = at->entries.try_emplace(part.name);
    at = &entry->second;
    if (made) {
      mark(*at, text);
      if (!part.indices.empty()) at->kind = TomlValue::Kind::array;
    }
    for (const std::size_t index : part.indices) {
      if (at->kind != TomlValue::Kind::array)
        refuse(path + " is not an array but " + kind_name(*at));
      if (index > at->items.size())
        refuse(path + " has " + std::to_string(at->items.size()) + " elements, counted from 0");
      if (index == at->items.size()) mark(at->items.emplace_back(), text);
      at = &at->items[index];
      path += "[" + std::to_string(index) + "]";
    }
  }
  *at = override_value(value);
  mark(*at, text);
}

}  // namespace peristat
