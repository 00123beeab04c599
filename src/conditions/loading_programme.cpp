#include "src/conditions/loading_programme.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/core/input_error.hpp"
#include "src/core/linear_table.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

void check(const std::vector<double>& table, std::size_t entries, const std::string& key) {
  if (table.size() < 2) throw InputError(key, "", "needs at least two entries");
  if (table.size() != entries) {
    throw InputError(key, "",
                     "has " + std::to_string(table.size()) + " entries, but the first table has " +
                         std::to_string(entries));
  }
  if (table.front() != 0.0) {
    throw InputError(key, number_text(table.front()),
                     "must begin with 0: the body starts at rest, without loads");
  }
  for (const double value : table) {
    if (!std::isfinite(value)) throw InputError(key, number_text(value), "must be finite");
  }
}

void check(const TimeTable& table, double end, const std::string& key) {
  if (table.size() < 2) throw InputError(key, "", "needs at least two pairs of a time and a value");
  if (table.front()[0] != 0.0) {
    throw InputError(key, number_text(table.front()[0]), "must begin at the time 0");
  }
  for (std::size_t k = 0; k < table.size(); ++k) {
    for (const double number : table[k]) {
      if (!std::isfinite(number)) throw InputError(key, number_text(number), "must be finite");
    }
    if (k > 0 && !(table[k][0] > table[k - 1][0])) {
      throw InputError(key, number_text(table[k][0]),
                       "must be later than the time before, " + number_text(table[k - 1][0]) +
                           " s: the times of a table ascend");
    }
  }
  constexpr double round_off = 1e-9;
  if (table.back()[0] < end * (1.0 - round_off)) {
    throw InputError(key, number_text(table.back()[0]),
                     "ends before the motion, which ends at " + number_text(end) +
                         " s; add a pair for the value from there on");
  }
}

}  // namespace

LoadingProgramme::LoadingProgramme(std::vector<std::vector<double>> tables)
    : tables_(std::move(tables)) {
  if (tables_.empty() || tables_.size() > most_parameters) {
    throw InputError("programme", std::to_string(tables_.size()),
                     "must have from 1 to " + std::to_string(most_parameters) + " tables");
  }
  for (std::size_t k = 0; k < tables_.size(); ++k) {
    check(tables_[k], tables_.front().size(), "programme[" + std::to_string(k) + "]");
  }
}

std::vector<std::string> LoadingProgramme::names(std::size_t parameters) {
  std::vector<std::string> names;
  for (std::size_t k = 1; k <= parameters; ++k) {
    names.emplace_back("load");
    if (k > 1) names.back() += std::to_string(k);
  }
  return names;
}

LoadingProgramme LoadingProgramme::of_time(double end, std::vector<TimeTable> loads) {
  if (!(end > 0.0) || !std::isfinite(end)) {
    throw InputError("end_time", number_text(end), "must be positive and finite [s]");
  }
  if (loads.size() > most_parameters) {
    throw InputError("programme", std::to_string(loads.size()),
                     "must have at most " + std::to_string(most_parameters) + " tables");
  }
  for (std::size_t k = 0; k < loads.size(); ++k) {
    check(loads[k], end, "programme[" + std::to_string(k) + "]");
  }
  LoadingProgramme programme;
  programme.end_time_ = end;
  programme.over_time_ = std::move(loads);
  return programme;
}

std::vector<std::string> LoadingProgramme::names() const {
  if (!is_of_time()) return names(parameters());
  std::vector<std::string> all = names(over_time_.size());
  all.insert(all.begin(), "t");
  return all;
}

std::vector<double> LoadingProgramme::at(double stage) const {
  if (is_of_time()) {
    std::vector<double> values{stage};
    for (const TimeTable& table : over_time_) values.push_back(interpolated(table, stage));
    return values;
  }
  const double entry = std::clamp(std::floor(stage), 0.0, end() - 1.0);
  const double share = stage - entry;
  const auto before = static_cast<std::size_t>(entry);
  std::vector<double> values;
  for (const std::vector<double>& table : tables_) {
    const double from = table[before], to = table[before + 1];
    values.push_back(share == 1.0 ? to : from + share * (to - from));
  }
  return values;
}

bool LoadingProgramme::is_at_new_load(double stage) const {
  if (is_of_time()) return true;
  const std::vector<double> values = at(stage);
  for (std::size_t k = 0; k < tables_.size(); ++k) {
    // Between two entries a parameter is no larger than at one of them.
    double largest_before = 0.0;
    for (std::size_t entry = 0; double(entry) < stage - tolerance; ++entry) {
      largest_before = std::max(largest_before, std::abs(tables_[k][entry]));
    }
    if (std::abs(values[k]) > largest_before) return true;
  }
  return false;
}

double LoadingProgramme::next_entry(double stage) { return std::floor(stage + tolerance) + 1.0; }

}  // namespace peristat
