#include "cases/runner/input/case_difference.hpp"

#include <algorithm>
#include <map>

#include "cases/runner/input/toml_value.hpp"

namespace peristat {
namespace {

constexpr std::size_t most_differences = 5;

/// Values as they are written, by dotted key.
using Written = std::map<std::string, std::string>;

void collect(const TomlValue& value, const std::string& path, Written& values) {
  for (const auto& [key, entry] : value.entries)
    collect(entry, path.empty() ? key : path + "." + key, values);
  if (value.is_array_of_tables()) {
    for (std::size_t k = 0; k < value.items.size(); ++k)
      collect(value.items[k], path + "[" + std::to_string(k) + "]", values);
  } else if (!value.is_table()) {
    values[path] = value.written;
  }
}

Written written(const std::string& text) {
  Written values;
  collect(parse_toml(text, "the case"), "", values);
  return values;
}

}  // namespace

std::vector<std::string> case_differences(const std::string& then, const std::string& now) {
  const Written before = written(then), after = written(now);
  std::vector<std::string> differences;
  for (const auto& [key, value] : before) {
    const auto found = after.find(key);
    if (found == after.end()) {
      differences.push_back(key + " has been removed, was " + value);
    } else if (found->second != value) {
      differences.push_back(key + " is " + found->second + ", was " + value);
    }
  }
  for (const auto& [key, value] : after) {
    if (!before.contains(key)) differences.push_back(key + " is " + value + ", was not given");
  }
  if (differences.empty() && then != now)
    differences.push_back("a value that spans several lines has changed");
  if (differences.size() > most_differences) {
    const std::size_t more = differences.size() - most_differences;
    differences.resize(most_differences);
    differences.push_back("and " + std::to_string(more) + " more");
  }
  return differences;
}

}  // namespace peristat
