#include "src/core/json_object.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "src/core/number_text.hpp"

namespace peristat {
namespace {

std::string finite_json(const std::string& key, double value) {
  if (!std::isfinite(value)) throw std::logic_error("JSON: " + key + " is " + number_text(value));
  return number_text(value);
}

/// "[a, b]" of the JSON of its items.
template <class Items, class Json>
std::string json_array(const Items& items, const Json& json_of) {
  std::string list;
  for (const auto& item : items) list += (list.empty() ? "" : ", ") + json_of(item);
  return "[" + list + "]";
}

/// JSON of an object, two blanks further in. Line ends of texts are escaped, so that all others
/// are between members.
std::string indented(std::string json) {
  for (std::size_t at = 0; (at = json.find('\n', at)) != std::string::npos; at += 3)
    json.replace(at, 1, "\n  ");
  return json;
}

}  // namespace

std::string json_string(const std::string& text) {
  std::string json = "\"";
  for (const char character : text) {
    if (character == '"' || character == '\\') {
      json += std::string("\\") + character;
    } else if (character == '\n') {
      json += "\\n";
    } else if (static_cast<unsigned char>(character) < 0x20) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(character));
      json += code;
    } else {
      json += character;
    }
  }
  return json + "\"";
}

JsonObject& JsonObject::add_json(const std::string& key, const std::string& json) {
  members_.emplace_back(key, json);
  return *this;
}

JsonObject& JsonObject::add(const std::string& key, const std::string& value) {
  return add_json(key, json_string(value));
}

JsonObject& JsonObject::add(const std::string& key, double value) {
  return add_json(key, finite_json(key, value));
}

JsonObject& JsonObject::add(const std::string& key, std::span<const double> values) {
  return add_json(key, json_array(values, [&](double value) { return finite_json(key, value); }));
}

JsonObject& JsonObject::add(const std::string& key, const std::vector<std::string>& texts) {
  return add_json(key, json_array(texts, json_string));
}

JsonObject& JsonObject::add(const std::string& key, const JsonObject& value) {
  return add_json(key, indented(value.text()));
}

JsonObject& JsonObject::add(const std::string& key, const std::vector<JsonObject>& values) {
  return add_json(
      key, json_array(values, [](const JsonObject& value) { return indented(value.text()); }));
}

JsonObject& JsonObject::add_missing(const JsonObject& other) {
  for (const auto& member : other.members_) {
    if (std::ranges::find(members_, member.first, &std::pair<std::string, std::string>::first) ==
        members_.end())
      members_.push_back(member);
  }
  return *this;
}

std::string JsonObject::text() const {
  std::string members;
  for (const auto& [key, json] : members_)
    members += (members.empty() ? "\n  " : ",\n  ") + json_string(key) + ": " + json;
  return members.empty() ? "{}" : "{" + members + "\n}";
}

}  // namespace peristat
