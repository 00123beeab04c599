#include "src/conditions/loading_programme.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/core/input_error.hpp"
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

LoadingProgramme LoadingProgramme::of_time(double end) {
  if (!(end > 0.0) || !std::isfinite(end)) {
    throw InputError("end_time", number_text(end), "must be positive and finite [s]");
  }
  LoadingProgramme programme;
  programme.end_time_ = end;
  return programme;
}

std::vector<std::string> LoadingProgramme::names() const {
  return is_of_time() ? std::vector<std::string>{"t"} : names(parameters());
}

std::vector<double> LoadingProgramme::at(double stage) const {
  if (is_of_time()) return {stage};
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
