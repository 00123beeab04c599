#include "cases/runner/results/tables/settings_table.hpp"

#include <string>
#include <variant>
#include <vector>

#include "cases/runner/results/files/table.hpp"

namespace peristat {
namespace {

constexpr const char* group = "/case/settings";

std::vector<Column> settings_columns() {
  constexpr auto text = Column::Kind::text;
  return {{text, "key", "none", "dotted key of the case file that --set has overridden"},
          {text, "value", "none", "the value (TOML)"}};
}

}  // namespace

void write_settings(Hdf5File& file, const Settings& settings) {
  std::vector<Row> rows;
  for (const auto& [key, value] : settings) rows.push_back({key, value});
  file.make_table(group, settings_columns());
  file.append(group, settings_columns(), rows);
}

Settings read_settings(const Hdf5File& file) {
  Settings settings;
  for (const Row& row : file.rows(group, settings_columns())) {
    settings.emplace_back(std::get<std::string>(row.at(0)), std::get<std::string>(row.at(1)));
  }
  return settings;
}

}  // namespace peristat
