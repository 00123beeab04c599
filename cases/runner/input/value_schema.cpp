#include "cases/runner/input/value_schema.hpp"

#include <cmath>

#include "cases/runner/input/quantity.hpp"

namespace peristat {
namespace {

/// Pattern of a number, and a unit behind it: "210 GPa", "2.5mm", "1e-5 1/K".
constexpr const char* quantity = R"(^ *[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)? *( 1/)?[^ \d.eE].*$)";

void add_limits(JsonObject& schema, const Range& range) {
  if (!range.limits_are_remote)
    schema.add("minimum", range.low).add("maximum", range.high);
  else if (range.low > 0.0)
    schema.add("exclusiveMinimum", 0);
  else if (range.low == 0.0)
    schema.add("minimum", 0);
}

}  // namespace

JsonObject number_schema(const Range& range, const std::string& unit) {
  std::vector<std::string> types{"number"};
  if (is_unit_of_measure(unit)) types.emplace_back("string");
  if (std::isinf(range.high)) types.emplace_back("null");  // JSON has no infinity
  JsonObject schema;
  if (types.size() == 1)
    schema.add("type", types.front());
  else
    schema.add("type", types);
  add_limits(schema, range);
  if (is_unit_of_measure(unit)) schema.add("pattern", quantity);
  return schema;
}

JsonObject integer_schema(std::int64_t low, std::int64_t high) {
  JsonObject schema;
  schema.add("type", "integer").add("minimum", low);
  constexpr std::int64_t exact = 9007199254740992;  // 2^53: editors hold numbers as doubles
  if (high <= exact) schema.add("maximum", high);
  return schema;
}

JsonObject boolean_schema() { return JsonObject().add("type", "boolean"); }

JsonObject text_schema() { return JsonObject().add("type", "string"); }

JsonObject choice_schema(const std::vector<std::string>& names) {
  return JsonObject().add("type", "string").add("enum", names);
}

JsonObject expression_schema() {
  return JsonObject().add("type", std::vector<std::string>{"number", "string"});
}

JsonObject list_schema(const JsonObject& item, std::size_t least, std::size_t most) {
  JsonObject schema;
  schema.add("type", "array").add("items", item).add("minItems", least);
  if (most > 0) schema.add("maxItems", most);
  return schema;
}

JsonObject components_schema(const JsonObject& component) { return list_schema(component, 1, 3); }

JsonObject table_schema(const JsonObject& keys) {
  JsonObject schema;
  schema.add("type", "object").add("properties", keys);
  return schema.add_json("additionalProperties", "false");
}

JsonObject either_schema(const std::vector<JsonObject>& schemas) {
  return JsonObject().add("anyOf", schemas);
}

}  // namespace peristat
