#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "src/constraints/constraints.hpp"
#include "src/core/communicator.hpp"
#include "src/geometry/numbered_points.hpp"

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

/// Linear constraints, each of which takes one degree of freedom out of the equations. Of a part of
/// a body all ranks have the same rows, each with the coefficients of the points that it owns.
class LinearRows {
 public:
  /// What the arguments refer to outlives it.
  /// @param prescribed by supports, per degree of freedom: these stay masters
  /// @param ranks that have parts of the body; null: it is whole
  /// @param numbers of the points of a part
  LinearRows(const Points& points, const std::vector<char>& prescribed, const Communicator* ranks,
             const NumberedPoints& numbers)
      : points_(points), prescribed_(prescribed), ranks_(ranks), numbers_(numbers) {}

  void push_back(LinearRow row) { rows_.push_back(std::move(row)); }

  /// Solves the rows for one degree of freedom each (Gauss and Jordan, the largest coefficient of a
  /// row first), and lets these follow. A call that all ranks make.
  /// @throws InputError for a row of prescribed displacements alone, or one that says what others
  ///         say
  void eliminate(Constraints& constraints);

 private:
  /// A row solved for its pivot, of coefficient 1; also of the handles' components.
  using Solved = std::map<std::size_t, double>;
  void note_held_dofs();
  /// Numbers degrees of freedom by the points of the whole body, and adds what other ranks have.
  void gather();
  [[nodiscard]] std::map<std::size_t, Solved> solve();
  [[nodiscard]] std::size_t pivot_of(const LinearRow& row, double size) const;
  /// The point or handle of a degree of freedom, if it is this rank's.
  [[nodiscard]] std::optional<Index> own_row(std::size_t dof) const;
  void follow(const std::map<std::size_t, Solved>& solved, Constraints& constraints) const;

  const Points& points_;
  const std::vector<char>& prescribed_;
  const Communicator* ranks_;
  NumberedPoints numbers_;
  std::vector<LinearRow> rows_;
  std::size_t first_handle_ = 0;  ///< degree of freedom
  std::set<std::size_t> held_{};  ///< degrees of freedom in rows that supports prescribe
};

}  // namespace peristat
