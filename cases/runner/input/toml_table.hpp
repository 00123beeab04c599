#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cases/runner/input/toml_value.hpp"

namespace peristat {

/// Allowed range of a number.
struct Range {
  double low = -1e30, high = 1e30;                ///< both allowed
  std::string words = "must be a finite number";  ///< for messages; with the unit
  /// The limits only keep products of such numbers from overflow; `words` don't name them.
  bool limits_are_remote = true;

  /// From 1e-30 to `high`.
  [[nodiscard]] static Range positive(const std::string& unit, double high = 1e30);
  [[nodiscard]] static Range between(double low, double high);
};

/// A table of a case file. All of its keys must be known. Every query refuses a wrong value with
/// the place, the key, the value and what is allowed.
///
/// A view: file name and value must outlive it.
class TomlTable {
 public:
  /// @param path dotted name of the table ("support[1]"), empty for the document
  /// @throws InputError if the value is no table or if one of its keys is unknown (see
  ///         case_keys.hpp)
  TomlTable(const TomlValue& value, std::string path, const std::string& file);

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string path(const std::string& key) const;
  [[nodiscard]] bool has(const std::string& key) const { return find(key) != nullptr; }

  /// Throws InputError: the value of the key (or the table, if it lacks the key) is wrong.
  [[noreturn]] void refuse(const std::string& key, const std::string& why) const;
  /// Like `refuse` for one element of the key's array.
  [[noreturn]] void refuse(const std::string& key, std::size_t element,
                           const std::string& why) const;
  /// Refuses all keys but these: keys that are known but have no effect here.
  void allow_only(const std::vector<std::string>& keys, const std::string& why) const;
  /// The one of the keys that is there. @throws InputError if there is none or more than one
  [[nodiscard]] std::string exactly_one(const std::vector<std::string>& keys) const;

  /// The following throw InputError if the key is missing.
  [[nodiscard]] std::string string(const std::string& key) const;
  [[nodiscard]] bool boolean(const std::string& key) const;
  [[nodiscard]] double number(const std::string& key, const Range& range) const;
  [[nodiscard]] std::int64_t integer(const std::string& key, std::int64_t low,
                                     std::int64_t high) const;
  /// A string out of a list.
  [[nodiscard]] std::string one_of(const std::string& key,
                                   const std::vector<std::string>& allowed) const;
  /// An array of numbers.
  [[nodiscard]] std::vector<double> numbers(const std::string& key, std::size_t count,
                                            const Range& range) const;
  /// An array of two numbers or more.
  [[nodiscard]] std::vector<double> numbers(const std::string& key, const Range& range) const;
  /// True if the value of the key is an array.
  [[nodiscard]] bool is_array(const std::string& key) const;
  /// True if the value of the key is a table.
  [[nodiscard]] bool is_table(const std::string& key) const;
  /// True if the value of the key is a string.
  [[nodiscard]] bool is_string(const std::string& key) const;
  /// An array of pairs of numbers.
  [[nodiscard]] std::vector<std::array<double, 2>> pairs(const std::string& key) const;
  /// An array of triples of numbers.
  [[nodiscard]] std::vector<std::array<double, 3>> triples(const std::string& key) const;
  /// An array of strings.
  [[nodiscard]] std::vector<std::string> strings(const std::string& key) const;
  /// An array of numbers and strings, all as text.
  [[nodiscard]] std::vector<std::string> components(const std::string& key,
                                                    std::size_t count) const;

  [[nodiscard]] TomlTable table(const std::string& key) const;
  /// An empty table in the place of a missing one.
  [[nodiscard]] TomlTable empty_table(const std::string& key) const;
  /// An array of tables; without the key there are none.
  [[nodiscard]] std::vector<TomlTable> tables(const std::string& key) const;

 private:
  template <std::size_t count>
  std::vector<std::array<double, count>> tuples(const std::string& key,
                                                const std::string& what) const;
  void refuse_unknown_kind() const;
  const TomlValue* find(const std::string& key) const;
  const TomlValue& need(const std::string& key) const;
  double checked_number(const TomlValue& value, const std::string& path, const Range& range) const;
  const std::vector<TomlValue>& items(const std::string& key, std::size_t count,
                                      const std::string& what) const;
  [[noreturn]] void refuse(const TomlValue& value, const std::string& path,
                           const std::string& why) const;

  const TomlValue* value_;
  std::string path_;
  const std::string* file_;
};

/// "a, b, c"
[[nodiscard]] std::string listed(const std::vector<std::string>& names);

/// "; did you mean NAME?" for a misspelt name, or nothing.
[[nodiscard]] std::string did_you_mean(const std::string& name,
                                       const std::vector<std::string>& candidates);

}  // namespace peristat
