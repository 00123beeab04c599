#include "cases/runner/input/toml_table.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

#include "cases/runner/input/case_keys.hpp"
#include "src/core/input_error.hpp"
#include "src/core/nearest_name.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

/// "lattice.shape" for "lattice.shape[2]"
std::string without_indices(const std::string& path) {
  std::string name;
  bool inside = false;
  for (const char c : path) {
    if (c == '[') inside = true;
    if (!inside) name += c;
    if (c == ']') inside = false;
  }
  return name;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Whole number that a value holds, as an integer or a float; nothing for other values.
std::optional<std::int64_t> whole_number(const TomlValue& value) {
  if (value.kind == TomlValue::Kind::integer) return value.integer;
  constexpr double exact = 9007199254740992.0;  // 2^53: doubles represent all integers up to it
  const double number = value.kind == TomlValue::Kind::real ? value.real : 0.5;
  if (!(std::abs(number) <= exact) || std::trunc(number) != number) return std::nullopt;
  return static_cast<std::int64_t>(number);
}

/// Symbols and names of data sheets and papers, in small letters without underscores, and the keys
/// for them.
const std::map<std::string, std::string>& keys_of_symbols() {
  static const std::string modulus = "material.youngs_modulus", ratio = "material.poisson_ratio",
                           expansion = "material.thermal_expansion",
                           energy = "material.damage.fracture_energy",
                           toughness = "material.damage.fracture_toughness",
                           strength = "material.damage.strength",
                           critical = "material.damage.critical";
  static const std::map<std::string, std::string> keys{
      {"e", modulus},
      {"young", modulus},
      {"youngs", modulus},
      {"youngmodulus", modulus},
      {"emodulus", modulus},
      {"elasticmodulus", modulus},
      {"nu", ratio},
      {"poisson", ratio},
      {"poissons", ratio},
      {"poissonsratio", ratio},
      {"rho", "material.density"},
      {"massdensity", "material.density"},
      {"alpha", expansion},
      {"cte", expansion},
      {"expansion", expansion},
      {"thermalexpansioncoefficient", expansion},
      {"g", energy},
      {"gc", energy},
      {"gf", energy},
      {"g0", energy},
      {"gic", energy},
      {"g1c", energy},
      {"energyreleaserate", energy},
      {"kic", toughness},
      {"k1c", toughness},
      {"kc", toughness},
      {"toughness", toughness},
      {"ft", strength},
      {"sigmat", strength},
      {"sigmac", strength},
      {"tensilestrength", strength},
      {"sc", critical},
      {"s0", critical},
      {"delta", "lattice.horizon_ratio or points.horizon"},
      {"dx", "lattice.spacing"}};
  return keys;
}

/// A key of the material as it is called seen from a table: by its name alone if it belongs there,
/// otherwise by that of its tables, which are those of a region if the table is.
std::string seen_from(const std::string& table, const std::string& key) {
  const std::string name = "material";
  const std::size_t at = table.rfind(name);
  const bool is_inside = at != std::string::npos && key.starts_with(name);
  const std::string whole = is_inside ? table.substr(0, at) + key : key;
  const std::size_t dot = whole.rfind('.');
  return whole.substr(0, dot) == table ? whole.substr(dot + 1) : whole;
}

/// "horizon_ratio" for "horizon": the one key that begins with the word.
std::string completed(const std::string& word, const std::vector<std::string>& known) {
  std::string whole;
  for (const std::string& key : known) {
    if (!key.starts_with(word + "_")) continue;
    if (!whole.empty()) return "";
    whole = key;
  }
  return whole;
}

/// Suggests a key in place of an unknown one: that of a symbol, one that begins with it or is
/// similar in this table, or the same one of another table.
std::string suggestion(const std::string& table, const std::string& key,
                       const std::vector<std::string>& known) {
  std::string symbol;
  for (const char c : key)
    if (c != '_') symbol += char(std::tolower(static_cast<unsigned char>(c)));
  const auto meant = keys_of_symbols().find(symbol);
  if (meant != keys_of_symbols().end()) return "; the key is " + seen_from(table, meant->second);
  const std::string whole = completed(key, known);
  if (!whole.empty()) return "; did you mean " + whole + "?";
  std::string text = did_you_mean(key, known);
  if (!text.empty()) return text;
  std::vector<std::string> elsewhere;
  for (const auto& [other, keys] : case_keys())
    if (contains(keys, key) && !repeats_another(other))
      elsewhere.push_back(other.empty() ? key : other + "." + key);
  constexpr std::size_t most_listed = 3;
  if (elsewhere.empty() || elsewhere.size() > most_listed) return "";
  for (const auto& place : elsewhere) {
    const bool is_last = &place == &elsewhere.back();
    text += (text.empty() ? "" : is_last ? " or " : ", ") + place;
  }
  return "; did you mean " + text + "?";
}

}  // namespace

Range Range::positive(const std::string& unit, double high) {
  return {1e-30, high, "must be a positive number [" + unit + "]", true};
}

Range Range::between(double low, double high) {
  return {low, high, "must be a number from " + number_text(low) + " to " + number_text(high),
          false};
}

TomlTable::TomlTable(const TomlValue& value, std::string path, const std::string& file)
    : value_(&value), path_(std::move(path)), file_(&file) {
  const bool in_array = !path_.empty() && path_.back() == ']';
  if (!value.is_table()) {
    refuse(value, path_,
           "must be a table, not " + kind_name(value) +
               (value.is_array_of_tables() ? "; write [" + path_ + "] once" : ""));
  }
  const auto& known = case_keys().at(without_indices(path_));
  // the first in the file, which is where the person looks
  const TomlValue* first = nullptr;
  std::string unknown;
  for (const auto& [key, entry] : value.entries) {
    if (contains(known, key)) continue;
    const auto at = [](const TomlValue& v) {
      return std::pair(v.location.line, v.location.column);
    };
    if (first != nullptr && at(*first) < at(entry)) continue;
    first = &entry;
    unknown = key;
  }
  if (first != nullptr) {
    refuse_unknown_kind();
    refuse(
        *first, this->path(unknown),
        "unknown key" + suggestion(path_, unknown, known) + "  (allowed: " + listed(known) + ")");
  }
  // Contact alone may have defaults for all its keys.
  if (in_array && value.entries.empty() && without_indices(path_) != "contact")
    refuse(value, path_, "is empty (allowed: " + listed(known) + ")");
}

/// Refuses an unknown kind of shape: its keys are unknown, too, but the kind is the mistake.
void TomlTable::refuse_unknown_kind() const {
  if (without_indices(path_) != "lattice.shape") return;
  for (const char* const key : {"add", "subtract"}) {
    if (is_string(key)) static_cast<void>(one_of(key, case_keys().at("set.shape")));
  }
}

std::string TomlTable::path(const std::string& key) const {
  return path_.empty() ? key : path_ + "." + key;
}

const TomlValue* TomlTable::find(const std::string& key) const {
  const auto entry = value_->entries.find(key);
  return entry == value_->entries.end() ? nullptr : &entry->second;
}

const TomlValue& TomlTable::need(const std::string& key) const {
  if (const auto* value = find(key)) return *value;
  const bool is_table = case_keys().count(without_indices(path(key))) > 0;
  refuse(*value_, path(key), is_table ? "this table is missing" : "this key is missing");
}

void TomlTable::refuse(const TomlValue& value, const std::string& path,
                       const std::string& why) const {
  throw InputError(path, value.written, why, value.location.text(*file_));
}

void TomlTable::refuse(const std::string& key, const std::string& why) const {
  const auto* value = find(key);
  refuse(value != nullptr ? *value : *value_, key.empty() ? path_ : path(key), why);
}

void TomlTable::refuse(const std::string& key, std::size_t element, const std::string& why) const {
  refuse(need(key).items.at(element), path(key) + "[" + std::to_string(element) + "]", why);
}

void TomlTable::allow_only(const std::vector<std::string>& keys, const std::string& why) const {
  for (const auto& [key, entry] : value_->entries)
    if (!contains(keys, key))
      refuse(entry, path(key), why + " (allowed here: " + listed(keys) + ")");
}

std::string TomlTable::exactly_one(const std::vector<std::string>& keys) const {
  std::string one;
  for (const auto& key : keys) {
    if (!has(key)) continue;
    if (!one.empty())
      refuse(key, "can't be given together with " + one + "; give exactly one of " + listed(keys));
    one = key;
  }
  if (one.empty()) refuse("", "needs exactly one of " + listed(keys));
  return one;
}

std::string TomlTable::string(const std::string& key) const {
  const TomlValue& value = need(key);
  if (value.kind == TomlValue::Kind::string) return value.string;
  // "--set output.directory=2024" needs no quotes
  if (!value.location.override_text.empty() && !value.is_table() &&
      value.kind != TomlValue::Kind::array)
    return value.written;
  refuse(value, path(key), "must be a string, not " + kind_name(value));
}

bool TomlTable::boolean(const std::string& key) const {
  const TomlValue& value = need(key);
  if (value.kind != TomlValue::Kind::boolean)
    refuse(value, path(key), "must be true or false, not " + kind_name(value));
  return value.boolean;
}

double TomlTable::checked_number(const TomlValue& value, const std::string& path,
                                 const Range& range) const {
  const bool is_integer = value.kind == TomlValue::Kind::integer;
  if (!is_integer && value.kind != TomlValue::Kind::real)
    refuse(value, path, range.words + ", not " + kind_name(value));
  const double number = is_integer ? static_cast<double>(value.integer) : value.real;
  if (number >= range.low && number <= range.high) return number;
  const bool beyond_limits =
      std::isfinite(number) && (number > range.high || range.low < 0.0 || number > 0.0);
  std::string words = range.words;
  if (range.limits_are_remote && beyond_limits)
    words += ", from " + number_text(range.low) + " to " + number_text(range.high);
  refuse(value, path, words);
}

double TomlTable::number(const std::string& key, const Range& range) const {
  return checked_number(need(key), path(key), range);
}

std::int64_t TomlTable::integer(const std::string& key, std::int64_t low, std::int64_t high) const {
  const TomlValue& value = need(key);
  const std::string words =
      "must be a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  const std::optional<std::int64_t> whole = whole_number(value);
  if (!whole && value.kind != TomlValue::Kind::real)
    refuse(value, path(key), words + ", not " + kind_name(value));
  if (!whole || *whole < low || *whole > high) refuse(value, path(key), words);
  return *whole;
}

std::string TomlTable::one_of(const std::string& key,
                              const std::vector<std::string>& allowed) const {
  const std::string name = string(key);
  if (contains(allowed, name)) return name;
  refuse(key, "not known" + did_you_mean(name, allowed) + "  (allowed: " + listed(allowed) + ")");
}

const std::vector<TomlValue>& TomlTable::items(const std::string& key, std::size_t count,
                                               const std::string& what) const {
  const TomlValue& value = need(key);
  const std::string words =
      "must be an array of " + (count > 0 ? std::to_string(count) + " " : "") + what;
  if (value.kind != TomlValue::Kind::array)
    refuse(value, path(key), words + ", not " + kind_name(value));
  if (value.items.empty()) refuse(value, path(key), words + "; this one is empty");
  if (count > 0 && value.items.size() != count) {
    refuse(value, path(key),
           words + " (one per dimension), not " + std::to_string(value.items.size()));
  }
  return value.items;
}

std::vector<double> TomlTable::numbers(const std::string& key, std::size_t count,
                                       const Range& range) const {
  std::vector<double> numbers;
  for (const auto& item : items(key, count, count == 1 ? "number" : "numbers")) {
    const std::string at = path(key) + "[" + std::to_string(numbers.size()) + "]";
    numbers.push_back(checked_number(item, at, range));
  }
  return numbers;
}

std::vector<double> TomlTable::numbers(const std::string& key, const Range& range) const {
  return numbers(key, 0, range);
}

bool TomlTable::is_array(const std::string& key) const {
  const TomlValue* const value = find(key);
  return value != nullptr && value->kind == TomlValue::Kind::array;
}

bool TomlTable::is_table(const std::string& key) const {
  const TomlValue* const value = find(key);
  return value != nullptr && value->is_table();
}

bool TomlTable::is_string(const std::string& key) const {
  const TomlValue* const value = find(key);
  return value != nullptr && value->kind == TomlValue::Kind::string;
}

template <std::size_t count>
std::vector<std::array<double, count>> TomlTable::tuples(const std::string& key,
                                                         const std::string& what) const {
  std::vector<std::array<double, count>> tuples;
  for (const auto& item : items(key, 0, what)) {
    const std::string at = path(key) + "[" + std::to_string(tuples.size()) + "]";
    if (item.kind != TomlValue::Kind::array || item.items.size() != count)
      refuse(item, at, "must be one of the " + what);
    for (std::size_t k = 0; k < count; ++k) {
      if (k == 0) tuples.emplace_back();
      tuples.back()[k] = checked_number(item.items[k], at + "[" + std::to_string(k) + "]", Range{});
    }
  }
  return tuples;
}

std::vector<std::array<double, 2>> TomlTable::pairs(const std::string& key) const {
  return tuples<2>(key, "pairs of numbers [x, y]");
}

std::vector<std::array<double, 3>> TomlTable::triples(const std::string& key) const {
  return tuples<3>(key, "triples of numbers [x, y, z]");
}

std::vector<std::string> TomlTable::strings(const std::string& key) const {
  std::vector<std::string> strings;
  for (const auto& item : items(key, 0, "strings")) {
    if (item.kind != TomlValue::Kind::string)
      refuse(item, path(key) + "[" + std::to_string(strings.size()) + "]", "must be a string");
    strings.push_back(item.string);
  }
  return strings;
}

std::vector<std::string> TomlTable::components(const std::string& key, std::size_t count) const {
  std::vector<std::string> components;
  for (const auto& item :
       items(key, count, count == 1 ? "number or expression" : "numbers or expressions")) {
    const std::string at = path(key) + "[" + std::to_string(components.size()) + "]";
    components.push_back(
        item.kind == TomlValue::Kind::string
            ? item.string
            : number_text(checked_number(
                  item, at, {-1e30, 1e30, "must be a finite number or a string", true})));
  }
  return components;
}

TomlTable TomlTable::table(const std::string& key) const {
  return TomlTable(need(key), path(key), *file_);
}

TomlTable TomlTable::empty_table(const std::string& key) const {
  static const TomlValue no_entries;
  return TomlTable(no_entries, path(key), *file_);
}

std::vector<TomlTable> TomlTable::tables(const std::string& key) const {
  std::vector<TomlTable> tables;
  const auto* array = find(key);
  if (array == nullptr) return tables;
  if (array->kind != TomlValue::Kind::array) {
    refuse(*array, path(key),
           "must be an array of tables, not " + kind_name(*array) +
               (array->is_table() ? "; write [[" + without_indices(path(key)) + "]]" : ""));
  }
  if (array->items.empty()) refuse(*array, path(key), "is empty; leave it out");
  for (std::size_t k = 0; k < array->items.size(); ++k)
    tables.emplace_back(array->items[k], path(key) + "[" + std::to_string(k) + "]", *file_);
  return tables;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string did_you_mean(const std::string& name, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_name(name, candidates);
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

}  // namespace peristat
