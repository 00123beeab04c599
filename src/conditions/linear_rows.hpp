#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "src/constraints/constraints.hpp"
#include "src/parallel/communicator.hpp"
#include "src/parallel/index_map.hpp"
#include "src/parallel/numbered_points.hpp"

namespace peristat {

/// Equation: sum of coefficient * displacement = a handle's degree of freedom `value`.
struct LinearRow {
  std::string key, who;  ///< for errors
  std::map<std::size_t, double> coefficient;
  std::size_t value;

  void add(std::size_t dof, double of_dof) {
    if (of_dof != 0.0) coefficient[dof] += of_dof;
  }
};

/// Linear constraints, each of which eliminates one degree of freedom. For a part of a body all
/// ranks have the same rows, each with the coefficients of the points that it owns.
class LinearRows {
 public:
  /// The arguments must outlive the object.
  /// @param prescribed by supports, per degree of freedom: these stay masters
  LinearRows(const Points& points, const std::vector<char>& prescribed, const IndexMap& index_map)
      : points_(points), prescribed_(prescribed), index_map_(index_map) {}

  void push_back(LinearRow row) { rows_.push_back(std::move(row)); }

  /// Solves each row for one degree of freedom (Gauss-Jordan elimination, the pivot is the row's
  /// largest coefficient) and makes these followers. Collective.
  /// @throws InputError for a row of prescribed displacements alone, or one that repeats or
  ///         contradicts others
  void eliminate(Constraints& constraints);

 private:
  /// Row solved for its pivot: the pivot is the sum of coefficient * degree of freedom, handles
  /// included.
  using Solved = std::map<std::size_t, double>;
  /// Renumbers degrees of freedom by the points of the whole body; adds the coefficients of other
  /// ranks.
  void gather();
  [[nodiscard]] std::map<std::size_t, Solved> solve();
  [[nodiscard]] std::size_t pivot_of(const LinearRow& row, double size) const;
  /// Returns the point or handle of a degree of freedom if this rank owns it.
  [[nodiscard]] std::optional<Index> own_row(std::size_t dof) const;
  void follow(const std::map<std::size_t, Solved>& solved, Constraints& constraints) const;

  const Points& points_;
  const std::vector<char>& prescribed_;
  const IndexMap& index_map_;
  std::vector<LinearRow> rows_;
  std::size_t first_handle_ = 0;  ///< degree of freedom
  std::set<std::size_t> held_{};  ///< degrees of freedom in rows that supports prescribe
};

}  // namespace peristat
