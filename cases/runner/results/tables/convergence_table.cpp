#include "cases/runner/results/tables/convergence_table.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/core/number_text.hpp"

namespace peristat {

void ConvergenceTable::add(const IterationRecord& record) {
  if (record.iteration <= last_iteration_) attempt_.clear();
  last_iteration_ = record.iteration;
  attempt_.push_back({record.residual, record.linear_tolerance});
}

void ConvergenceTable::accept(int step) {
  std::vector<ResidualRatio> ratios = std::exchange(attempt_, {});
  last_iteration_ = -1;
  if (step == 0 && ratios.empty()) return;  // the body at rest needed no search
  const double first = ratios.empty() ? 0.0 : ratios.front().value;
  for (ResidualRatio& ratio : ratios) ratio.value = first > 0.0 ? ratio.value / first : 0.0;
  columns_.push_back({step, std::move(ratios)});
}

std::string ConvergenceTable::csv() const {
  std::size_t rows = 0;
  std::string text = "iteration", orders = "observed_order";
  for (const Column& column : columns_) {
    rows = std::max(rows, column.ratios.size());
    text += ",step_" + std::to_string(column.step);
    const std::optional<double> order = observed_order(column.ratios);
    orders += "," + (order ? number_text(*order) : "");
  }
  for (std::size_t row = 0; row < rows; ++row) {
    text += "\n" + std::to_string(row);
    for (const Column& column : columns_) {
      text += "," + (row < column.ratios.size() ? number_text(column.ratios[row].value) : "");
    }
  }
  return text + "\n" + orders + "\n";
}

std::optional<double> observed_order(const std::vector<ResidualRatio>& ratios) {
  constexpr double far = 0.2, round_off = 1e-13, clear_of_linear_error = 100.0;
  const auto is_exact = [&](std::size_t k) {
    return ratios[k].value >
           clear_of_linear_error * ratios[k].linear_tolerance * ratios[k - 1].value;
  };
  for (std::size_t k = ratios.size(); k-- > 2;) {
    const double before = ratios[k - 2].value, now = ratios[k - 1].value, after = ratios[k].value;
    if (after > round_off && before < far && now < before && is_exact(k) && is_exact(k - 1))
      return std::log(after / now) / std::log(now / before);
  }
  return std::nullopt;
}

}  // namespace peristat
