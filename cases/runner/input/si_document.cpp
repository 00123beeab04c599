#include "cases/runner/input/si_document.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "cases/runner/input/case_keys.hpp"
#include "cases/runner/input/expression_tokens.hpp"
#include "cases/runner/input/si_expression.hpp"
#include "solvers/observe/point_fields.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

using TomlKind = TomlValue::Kind;
using TypedValues = std::map<std::string, std::string>;

/// Keys by their tables.
const KeyDescription* description(const std::string& table, const std::string& key) {
  static const auto all = [] {
    std::map<std::pair<std::string, std::string>, const KeyDescription*> keys;
    for (const TableDescription& described : table_descriptions())
      for (const KeyDescription& one : described.keys) keys[{described.name, one.name}] = &one;
    return keys;
  }();
  const auto found = all.find({table, key});
  return found == all.end() ? nullptr : found->second;
}

std::string string_in(const TomlValue& table, const std::string& key) {
  const auto found = table.entries.find(key);
  return found != table.entries.end() ? found->second.string : std::string();
}

/// Converts the values of one key.
class KeyConversion {
 public:
  /// @param unit of the key; empty: it is a condition
  KeyConversion(ValueForm form, std::string unit, const UnitSystem& units, const std::string& file,
                TypedValues& typed)
      : form_(form), name_(std::move(unit)), units_(units), file_(file), typed_(typed) {
    if (!name_.empty()) value_.si = unit_of_key(name_);
    value_.given = units.unit_of(value_.si.dimension);
    // Angles have no unit in [units]: degrees stay degrees.
    if (value_.si.dimension == unit_of_key("rad").dimension) value_.given = value_.si;
  }

  void convert(TomlValue& value, const std::string& path) const {
    if (value.kind == TomlKind::array) {
      for (std::size_t k = 0; k < value.items.size(); ++k)
        convert(value.items[k], path + "[" + std::to_string(k) + "]");
    } else if (value.kind == TomlKind::integer || value.kind == TomlKind::real) {
      convert_number(value, path);
    } else if (value.kind == TomlKind::string) {
      convert_string(value, path);
    }
  }

 private:
  [[noreturn]] void refuse(const TomlValue& value, const std::string& path,
                           const std::string& why) const {
    throw InputError(path, value.written, why, value.location.text(file_));
  }

  void convert_number(TomlValue& value, const std::string& path) const {
    const Unit scale = value_.given / value_.si;
    if (scale.has_size_of({})) return;
    const std::string text =
        value.kind == TomlKind::integer ? std::to_string(value.integer) : number_text(value.real);
    if (length_of_number(text) == text.size()) set(value, path, in_unit(text, scale));
  }

  void set(TomlValue& value, const std::string& path, std::optional<double> number) const {
    if (!number) refuse(value, path, "is too large or too small for a number");
    typed_[path] = value.kind == TomlKind::string ? value.string : value.written;
    value.kind = TomlKind::real;
    value.real = *number;
  }

  void convert_string(TomlValue& value, const std::string& path) const {
    const std::string_view text = trimmed(value.string);
    const std::size_t number = length_of_number(text);
    const std::string_view unit = trimmed(text.substr(number));
    const bool has_unit = number > 0 && !unit.empty() && !name_.empty();
    const bool is_number = form_ != ValueForm::expression;
    // Other strings are left to the reader, which refuses them if the key takes numbers alone.
    if (is_number && !has_unit) return;
    try {
      if (is_number || (has_unit && is_quantity(text, unit))) {
        set(value, path, in_unit(text.substr(0, number), unit_in(value, path, unit) / value_.si));
        return;
      }
      const std::string si = in_si(
          value.string, units_, name_.empty() ? std::nullopt : std::optional<UnitOfValue>(value_));
      if (si != value.string) typed_[path] = std::exchange(value.string, si);
    } catch (const InputError& error) {
      refuse(value, path, error.allowed());
    }
  }

  /// True for one number and its unit; false for "2 m/s*t", where t is the time and no tonne.
  bool is_quantity(std::string_view text, std::string_view unit_text) const {
    std::string why_not;
    const std::optional<Unit> unit = parse_unit(unit_text, why_not);
    if (!unit || unit->dimension == value_.si.dimension) return unit.has_value();
    const bool is_signed = text.front() == '-' || text.front() == '+';
    return tokens_of(text.substr(is_signed ? 1 : 0)).size() == 1;
  }

  Unit unit_in(const TomlValue& value, const std::string& path, std::string_view text) const {
    std::string why_not;
    const std::optional<Unit> unit = parse_unit(text, why_not);
    const std::string expected = "must be " + words_for(value_.si, name_);
    if (!unit) refuse(value, path, why_not + "; " + expected);
    if (unit->dimension == value_.si.dimension) return *unit;
    const std::string other = name_of(unit->dimension);
    refuse(value, path,
           expected + (other.empty() ? "" : "; " + std::string(text) + " is the unit of " + other));
  }

  static std::string_view trimmed(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    return text;
  }

  ValueForm form_;
  std::string name_;
  UnitOfValue value_;
  const UnitSystem& units_;
  const std::string& file_;
  TypedValues& typed_;
};

/// Unit of a key; of some it depends on other keys.
std::string unit_of(const KeyDescription& key, const std::string& table, const TomlValue& in,
                    bool has_controls) {
  if (table == "loading" && has_controls && key.name == "table") return "m";
  if (table == "probe" && key.name == "expected") {
    const std::string given = string_in(in, "field");
    const PointField* const field = point_field(given.empty() ? "displacement" : given);
    if (field != nullptr && is_unit_of_measure(field->unit)) return field->unit;
  }
  return key.unit;
}

class Conversion {
 public:
  Conversion(const TomlValue& document, const UnitSystem& units, const std::string& file)
      : units_(units), file_(file), has_controls_(document.entries.contains("control")) {}

  /// @param name of the table without indices
  void convert(TomlValue& table, const std::string& name, const std::string& path) {
    for (auto& [key, value] : table.entries) {
      const std::string inner = name.empty() ? key : name + "." + key;
      const std::string at = path.empty() ? key : path + "." + key;
      if (value.is_table()) {
        convert(value, inner, at);
      } else if (value.is_array_of_tables()) {
        for (std::size_t k = 0; k < value.items.size(); ++k)
          convert(value.items[k], inner, at + "[" + std::to_string(k) + "]");
      } else if (const KeyDescription* const known = description(name, key)) {
        if (name == "loading") convert_times(value, at);
        const std::string unit = unit_of(*known, name, table, has_controls_);
        if (is_unit_of_measure(unit) || known->form == ValueForm::expression)
          KeyConversion(known->form, unit, units_, file_, typed).convert(value, at);
      }
    }
  }

  TypedValues typed{};

 private:
  /// Converts the times of a table over time, pairs of a time and a load.
  void convert_times(TomlValue& table, const std::string& path) {
    if (table.kind != TomlValue::Kind::array) return;
    const KeyConversion time(ValueForm::number, "s", units_, file_, typed);
    for (std::size_t k = 0; k < table.items.size(); ++k) {
      std::vector<TomlValue>& pair = table.items[k].items;
      if (!pair.empty()) time.convert(pair[0], path + "[" + std::to_string(k) + "][0]");
    }
  }

  const UnitSystem& units_;
  const std::string& file_;
  bool has_controls_;
};

}  // namespace

std::map<std::string, std::string> convert_to_si(TomlValue& document, const UnitSystem& units,
                                                 const std::string& file) {
  Conversion conversion(document, units, file);
  conversion.convert(document, "", "");
  return std::move(conversion.typed);
}

}  // namespace peristat
