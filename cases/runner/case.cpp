#include "cases/runner/case.hpp"

#include "cases/runner/case_file.hpp"
#include "cases/runner/key_table.hpp"
#include "cases/runner/toml_table.hpp"
#include "src/input_error.hpp"

namespace peristat {
namespace {

void collect_locations(const TomlValue& value, const std::string& path,
                       std::map<std::string, CaseLocation>& locations) {
  if (!path.empty()) locations[path] = value.location;
  for (const auto& [key, entry] : value.entries)
    collect_locations(entry, path.empty() ? key : path + "." + key, locations);
  for (std::size_t k = 0; k < value.items.size(); ++k)
    collect_locations(value.items[k], path + "[" + std::to_string(k) + "]", locations);
}

/// Place of a key, or of the longest part of it that the case file has.
CaseLocation location_of(const Case& from, const std::string& key) {
  for (std::string part = key; !part.empty();) {
    const auto known = from.locations.find(part);
    if (known != from.locations.end()) return known->second;
    const auto cut = part.find_last_of(".[");
    part.resize(cut == std::string::npos ? 0 : cut);
  }
  return {};
}

}  // namespace

Case read_case(const std::filesystem::path& file,
               const std::vector<std::pair<std::string, std::string>>& overrides) {
  Case result;
  result.file = file.string();
  result.as_read = read_case_text(file);

  TomlValue document = parse_toml(result.as_read, result.file);
  for (const auto& [key, value] : overrides) apply_override(document, key, value);
  collect_locations(document, "", result.locations);
  try {
    document_keys().read({TomlTable(document, "", result.file), "", result}, result);
  } catch (const InputError& error) {
    throw located(result, error);
  }
  result.as_resolved = document_keys().lines(result, result);
  return result;
}

std::string located(const Case& from, const std::string& key, const std::string& message) {
  return location_of(from, key).text(from.file) + ": " + message;
}

InputError located(const Case& from, const InputError& error) {
  if (!error.place().empty()) return error;
  return InputError(error.key(), error.value(), error.allowed(),
                    location_of(from, error.key()).text(from.file));
}

}  // namespace peristat
