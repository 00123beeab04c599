#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "src/constraints/constraints.hpp"

namespace peristat {

/// sum of coefficient * displacement = the component of a handle.
struct LinearRow {
  std::string key, who;  ///< for errors
  std::map<std::size_t, double> coefficient;
  std::size_t value;

  void add(std::size_t dof, double of_dof) {
    if (of_dof != 0.0) coefficient[dof] += of_dof;
  }
};

/// Linear constraints, each of which takes one degree of freedom out of the equations.
class LinearRows {
 public:
  /// @param prescribed by supports, per degree of freedom: these stay masters
  LinearRows(int dimension, const std::vector<char>& prescribed)
      : dimension_(dimension), prescribed_(prescribed) {}

  void push_back(LinearRow row) { rows_.push_back(std::move(row)); }

  /// Solves the rows for one degree of freedom each (Gauss and Jordan, the largest coefficient of a
  /// row first), and lets these follow.
  /// @throws InputError for a row of prescribed displacements alone, or one that says what others
  ///         say
  void eliminate(Constraints& constraints);

 private:
  [[nodiscard]] std::size_t pivot_of(const LinearRow& row, double size) const;

  int dimension_;
  const std::vector<char>& prescribed_;
  std::vector<LinearRow> rows_;
};

}  // namespace peristat
