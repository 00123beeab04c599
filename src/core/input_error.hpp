#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "src/core/readable_text.hpp"

namespace peristat {

/// Wrong input, reported to the person who wrote it (exit code 2).
///
/// Code below the runner names the input in its own terms: the member of a specification
/// ("supports[1].displacement[0]"), the value found and what is allowed. The runner, which knows
/// the case file, replaces the member by its key and puts file, line and column in front. Quoted
/// input is shortened and has no control characters (readable_text.hpp).
class InputError : public std::runtime_error {
 public:
  /// @param key   dotted key of the case file, below the runner a member; or empty
  /// @param value the offending value as text, or empty
  /// @param allowed a sentence that says what is wrong and what is allowed
  /// @param place where it stands ("case.toml:12:3"), put in front of the message, or empty
  InputError(std::string key, std::string value, std::string allowed, std::string place = {})
      : std::runtime_error((place.empty() ? "" : readable(place, most_of_place) + ": ") +
                           join(key, value, allowed)),
        key_(std::move(key)),
        value_(std::move(value)),
        allowed_(std::move(allowed)),
        place_(std::move(place)) {}

  [[nodiscard]] const std::string& key() const { return key_; }
  [[nodiscard]] const std::string& value() const { return value_; }
  [[nodiscard]] const std::string& allowed() const { return allowed_; }
  /// Empty until code that knows the file fills it in.
  [[nodiscard]] const std::string& place() const { return place_; }

  /// "key = value: allowed", without the parts that are empty.
  [[nodiscard]] static std::string join(const std::string& key, const std::string& value,
                                        const std::string& allowed) {
    std::string text = readable(key, most_of_value);
    if (!value.empty()) text += (text.empty() ? "" : " = ") + readable(value, most_of_value);
    return (text.empty() ? text : text + ": ") + readable(allowed, most_of_sentence);
  }

 private:
  /// Most characters of the parts of a message. The sentence may quote a value and list all known
  /// keys.
  static constexpr std::size_t most_of_value = 80, most_of_place = 300, most_of_sentence = 2000;

  std::string key_, value_, allowed_, place_;
};

}  // namespace peristat
