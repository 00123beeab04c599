#pragma once

#include <concepts>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace peristat {

/// Text as a JSON string, with the quotes.
[[nodiscard]] std::string json_string(const std::string& text);

/// A JSON object that is written: its members in the order in which they are added.
class JsonObject {
 public:
  /// Adds the text of any JSON value.
  JsonObject& add_json(const std::string& key, const std::string& json);

  JsonObject& add(const std::string& key, const std::string& value);
  JsonObject& add(const std::string& key, const char* value) {
    return add(key, std::string(value));
  }
  JsonObject& add(const std::string& key, std::integral auto value) {
    return add_json(key, std::to_string(value));
  }
  /// @throws std::logic_error that names the key if the value is not finite, as below
  JsonObject& add(const std::string& key, double value);
  JsonObject& add(const std::string& key, std::span<const double> values);
  JsonObject& add(const std::string& key, const std::vector<std::string>& texts);
  JsonObject& add(const std::string& key, const JsonObject& value);
  JsonObject& add(const std::string& key, const std::vector<JsonObject>& values);

  /// Adds those members of another object whose keys this one lacks.
  JsonObject& add_missing(const JsonObject& other);

  /// A member per line, indented by two blanks.
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::pair<std::string, std::string>> members_;  // keys and JSON of the values
};

}  // namespace peristat
