#include "cases/runner/commands/unknown_option.hpp"

#include <algorithm>

#include "cases/runner/input/case_keys.hpp"
#include "src/core/nearest_name.hpp"
#include "src/core/readable_text.hpp"

namespace peristat {
namespace {

constexpr std::size_t most_of_word = 80, most_keys = 3;

/// Dotted keys of this name in tables (not in arrays of tables, whose elements need a number).
std::vector<std::string> keys_named(const std::string& name) {
  std::vector<std::string> found;
  for (const std::string table : {"", "lattice", "quadrature", "material", "material.damage",
                                  "material.fibre", "loading", "solver", "relaxation", "output"}) {
    const auto known = case_keys().find(table);
    if (known == case_keys().end()) continue;
    const std::vector<std::string>& keys = known->second;
    const bool is_table = case_keys().count(table.empty() ? name : table + "." + name) > 0;
    if (is_table || std::find(keys.begin(), keys.end(), name) == keys.end()) continue;
    found.push_back(table.empty() ? name : table + "." + name);
  }
  // "--steps" is the loading's, not the relaxation's
  std::stable_partition(found.begin(), found.end(),
                        [](const std::string& key) { return key.starts_with("loading."); });
  return found;
}

}  // namespace

std::string describe_unknown(const std::vector<std::string>& words,
                             const std::vector<std::string>& options, bool takes_set) {
  const std::string& word = words.front();
  if (!word.starts_with("--")) {
    return "\"" + readable(word, most_of_word) + "\" is not expected here";
  }
  const std::size_t equals = word.find('=');
  const std::string option = word.substr(0, equals);
  std::string name = option.substr(2), value = "VALUE";
  if (equals != std::string::npos) {
    value = word.substr(equals + 1);
  } else if (words.size() > 1 && !words[1].starts_with("--")) {
    value = words[1];
  }
  std::replace(name.begin(), name.end(), '-', '_');
  const std::vector<std::string> keys = takes_set ? keys_named(name) : std::vector<std::string>();
  std::string meant;
  for (std::size_t k = 0; k < std::min(keys.size(), most_keys); ++k) {
    meant +=
        (meant.empty() ? "--set " : " or --set ") + keys[k] + "=" + readable(value, most_of_word);
  }
  if (meant.empty()) meant = nearest_name(option, options);
  return "unknown option " + readable(option, most_of_word) +
         (meant.empty() ? "" : "; did you mean " + meant + "?");
}

}  // namespace peristat
