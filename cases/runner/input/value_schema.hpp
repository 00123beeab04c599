#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cases/runner/input/toml_table.hpp"
#include "src/core/json_object.hpp"

/// JSON schemas (draft-07) of the values of keys. Each kind of values has one; UntypedTable::schema
/// puts them together.
namespace peristat {

/// A number of the range. Remote limits only say whether it may be zero or negative. With a
/// unit of measure also a text such as "210 GPa".
[[nodiscard]] JsonObject number_schema(const Range& range, const std::string& unit);
[[nodiscard]] JsonObject integer_schema(std::int64_t low, std::int64_t high);
[[nodiscard]] JsonObject boolean_schema();
[[nodiscard]] JsonObject text_schema();
/// One of these texts.
[[nodiscard]] JsonObject choice_schema(const std::vector<std::string>& names);
/// A number, or a text that is an expression or a word like "free".
[[nodiscard]] JsonObject expression_schema();
/// An array of `least` to `most` items; any number from `least` on if `most` is 0.
[[nodiscard]] JsonObject list_schema(const JsonObject& item, std::size_t least,
                                     std::size_t most = 0);
/// A component per dimension.
[[nodiscard]] JsonObject components_schema(const JsonObject& component);
/// A table with no other keys than these.
[[nodiscard]] JsonObject table_schema(const JsonObject& keys);
/// Values of any of these schemas.
[[nodiscard]] JsonObject either_schema(const std::vector<JsonObject>& schemas);

}  // namespace peristat
