#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "cases/runner/input/case_location.hpp"

namespace peristat {

/// A value of a TOML text together with the place it stands at.
struct TomlValue {
  enum class Kind { boolean, integer, real, string, date, array, table };

  Kind kind = Kind::table;
  bool boolean = false;
  std::int64_t integer = 0;
  double real = 0.0;
  std::string string;
  std::vector<TomlValue> items;              ///< of an array
  std::map<std::string, TomlValue> entries;  ///< of a table

  std::string written;    ///< as the person wrote it; empty for tables and for more than one line
  CaseLocation location;  ///< of the key, of a table's header, or of an array's element

  [[nodiscard]] bool is_table() const { return kind == Kind::table; }
  [[nodiscard]] bool is_array_of_tables() const;
};

/// "a number", "a table", … for messages.
[[nodiscard]] std::string kind_name(const TomlValue& value);

/// Parses a TOML text.
/// @param file name of the text in messages
/// @throws InputError with FILE:LINE:COLUMN if the text is not TOML
[[nodiscard]] TomlValue parse_toml(const std::string& text, const std::string& file);

/// Sets one key of a document: "loading.steps", "support[0].displacement"; missing tables on the
/// way are made, and the index after the last one adds an element. A value that is no TOML is a
/// string.
/// @throws InputError at "--set KEY=VALUE" if the key can't be followed
void apply_override(TomlValue& document, const std::string& key, const std::string& value);

}  // namespace peristat
