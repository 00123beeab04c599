#include "src/conditions/linear_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// A coefficient below this share of the row's largest one is what round-off has left of it.
constexpr double vanished = 1e-10;

/// Most coefficients of a row: each becomes a dense row of the tangent.
constexpr std::size_t most_coefficients = 20'000;

/// A row solved for its pivot, of coefficient 1; also of the handles' components.
using Solved = std::map<std::size_t, double>;

void add_multiple(Solved& to, const Solved& row, double factor) {
  for (const auto& [dof, coefficient] : row) to[dof] += factor * coefficient;
}

}  // namespace

std::size_t LinearRows::pivot_of(const LinearRow& row, double size) const {
  std::size_t pivot = prescribed_.size();
  double largest = vanished * size;
  for (const auto& [dof, coefficient] : row.coefficient) {
    if (dof >= prescribed_.size() || prescribed_[dof]) continue;
    if (std::abs(coefficient) > largest * (1.0 + 1e-9)) {
      pivot = dof;
      largest = std::abs(coefficient);
    }
  }
  if (pivot < prescribed_.size()) return pivot;
  throw InputError(row.key, "",
                   row.who +
                       " holds nothing that is free: supports prescribe all displacements in it, "
                       "or other constraints say the same or contradict it");
}

void LinearRows::eliminate(Constraints& constraints) {
  std::map<std::size_t, Solved> solved;  // by pivot
  for (LinearRow& row : rows_) {
    if (row.coefficient.size() > most_coefficients) {
      throw InputError(row.key, "",
                       row.who + " has " + std::to_string(row.coefficient.size()) +
                           " points: more than " + std::to_string(most_coefficients) +
                           " coefficients would fill the tangent. Use a smaller set");
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

  const std::size_t d = std::size_t(dimension_);
  std::map<Index, std::pair<std::array<bool, 3>, std::map<Index, Dependence>>> of_point;
  for (const auto& [pivot, row] : solved) {
    auto& [follows, masters] = of_point[static_cast<Index>(pivot / d)];
    follows[pivot % d] = true;
    for (const auto& [dof, coefficient] : row) {
      const Index master = static_cast<Index>(dof / d);
      Dependence& on = masters[master];
      on.master = master;
      on.block[pivot % d][dof % d] += coefficient;
    }
  }
  for (auto& [point, follower] : of_point) {
    std::vector<Dependence> masters;
    for (auto& [master, on] : follower.second) masters.push_back(on);
    constraints.follow(point, follower.first, std::move(masters));
  }
}

}  // namespace peristat
