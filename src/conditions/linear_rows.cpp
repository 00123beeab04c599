#include "src/conditions/linear_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "src/core/input_error.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// A coefficient below this fraction of the row's largest one is round-off.
constexpr double vanished = 1e-10;

/// Most coefficients of a row: each becomes a dense row of the tangent.
constexpr std::size_t most_coefficients = 20'000;

using Row = std::map<std::size_t, double>;

void add_multiple(Row& to, const Row& row, double factor) {
  for (const auto& [dof, coefficient] : row) to[dof] += factor * coefficient;
}

}  // namespace

void LinearRows::gather() {
  const auto d = std::size_t(points_.dimension);
  std::vector<double> coefficients;  // row, degree of freedom, coefficient, prescribed
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    for (const auto& [dof, coefficient] : rows_[k].coefficient) {
      const auto point = Index(dof / d);
      const double of_body = double(index_map_.number_of(point)) * double(d) + double(dof % d);
      coefficients.insert(coefficients.end(),
                          {double(k), of_body, coefficient, double(prescribed_[dof])});
    }
    rows_[k].coefficient.clear();
  }
  coefficients = concatenated(index_map_.ranks(), coefficients);
  const std::size_t handles_here = prescribed_.size();
  first_handle_ = d << 50;  // above those of points
  for (LinearRow& row : rows_) row.value += first_handle_ - handles_here;
  for (std::size_t k = 0; k < coefficients.size(); k += 4) {
    const auto dof = std::size_t(coefficients[k + 1]);
    rows_[std::size_t(coefficients[k])].add(dof, coefficients[k + 2]);
    if (coefficients[k + 3] != 0.0) held_.insert(dof);
  }
}

std::size_t LinearRows::pivot_of(const LinearRow& row, double size) const {
  std::size_t pivot = first_handle_;
  double largest = vanished * size;
  for (const auto& [dof, coefficient] : row.coefficient) {
    if (dof >= first_handle_ || held_.contains(dof)) continue;
    if (std::abs(coefficient) > largest * (1.0 + 1e-9)) {
      pivot = dof;
      largest = std::abs(coefficient);
    }
  }
  if (pivot < first_handle_) return pivot;
  throw InputError(row.key, "",
                   row.who +
                       " contains no free displacement: supports prescribe all of its "
                       "displacements, or other constraints repeat or contradict it");
}

void LinearRows::eliminate(Constraints& constraints) {
  if (rows_.empty()) return;
  gather();
  follow(solve(), constraints);
}

std::map<std::size_t, LinearRows::Solved> LinearRows::solve() {
  std::map<std::size_t, Solved> solved;  // by pivot
  for (LinearRow& row : rows_) {
    if (row.coefficient.size() > most_coefficients) {
      throw InputError(row.key, "",
                       row.who + " has " + std::to_string(row.coefficient.size()) +
                           " points: more than " + std::to_string(most_coefficients) +
                           " coefficients would fill up the tangent. Use a smaller set");
    }
    double size = 0.0;
    for (const auto& [dof, coefficient] : row.coefficient) {
      size = std::max(size, std::abs(coefficient));
    }
    row.add(row.value, -1.0);
    for (const auto& [pivot, of_pivot] : solved) {
      const auto found = row.coefficient.find(pivot);
      if (found == row.coefficient.end()) continue;
      const double factor = found->second;
      row.coefficient.erase(found);
      add_multiple(row.coefficient, of_pivot, factor);
    }
    const std::size_t pivot = pivot_of(row, size);
    Solved of_pivot;
    for (const auto& [dof, coefficient] : row.coefficient) {
      if (dof != pivot && coefficient != 0.0) {
        of_pivot[dof] = -coefficient / row.coefficient[pivot];
      }
    }
    for (auto& [other, of_other] : solved) {
      const auto found = of_other.find(pivot);
      if (found == of_other.end()) continue;
      const double factor = found->second;
      of_other.erase(found);
      add_multiple(of_other, of_pivot, factor);
    }
    solved.emplace(pivot, std::move(of_pivot));
  }
  return solved;
}

std::optional<Index> LinearRows::own_row(std::size_t dof) const {
  const auto d = std::size_t(points_.dimension);
  if (dof < first_handle_) {
    const std::optional<Index> point = index_map_.find(GlobalIndex(dof / d));
    return point && index_map_.owns(*point) ? point : std::nullopt;
  }
  if (!index_map_.is_first_rank()) return std::nullopt;
  return points_.count() + static_cast<Index>((dof - first_handle_) / d);
}

void LinearRows::follow(const std::map<std::size_t, Solved>& solved,
                        Constraints& constraints) const {
  const auto d = std::size_t(points_.dimension);
  std::map<std::size_t, std::pair<std::array<bool, 3>, std::map<Index, Dependence>>> of_point;
  for (const auto& [pivot, row] : solved) {
    auto& [follows, masters] = of_point[pivot / d];
    follows[pivot % d] = true;
    for (const auto& [dof, coefficient] : row) {
      const std::optional<Index> master = own_row(dof);
      if (!master) continue;
      Dependence& on = masters[*master];
      on.master = *master;
      on.block[pivot % d][dof % d] += coefficient;
    }
  }
  for (auto& [point, follower] : of_point) {
    std::vector<Dependence> masters;
    for (auto& [master, on] : follower.second) masters.push_back(on);
    constraints.follow({index_map_.find(GlobalIndex(point)), follower.first, std::move(masters)});
  }
}

}  // namespace peristat
