#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "assembly/terms/model.hpp"
#include "cases/runner/results/files/point_rows.hpp"
#include "solvers/drivers/state_archive.hpp"
#include "solvers/observe/recorded_points.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Maps the values of a path's state on this rank to the arrays of the whole body. Points and their
/// degrees of freedom are in the order of their numbers in the whole body, bonds in that of their
/// lower and then of their upper point, as on one rank. Each value is reported by one rank. All
/// calls are collective.
class StateNumbering {
 public:
  /// All arguments must outlive this object.
  StateNumbering(const RecordedPoints& points, const RowGathering& gathering, const Model& model,
                 const std::vector<char>& prescribed);

  [[nodiscard]] const RowGathering& gathering() const { return gathering_; }

  /// Size of an array of the whole body, from that of its part here.
  [[nodiscard]] std::int64_t whole_size(Rows rows, std::size_t here);
  /// Size of the part here of an array; nothing if no array of the body has the size.
  [[nodiscard]] std::optional<std::size_t> size_here(Rows rows, std::int64_t whole);

  /// Positions of a value that this rank reports.
  struct Place {
    std::int64_t whole;
    std::size_t here;
  };
  /// Positions of all values that this rank reports, ascending. The size must come from one of the
  /// functions above.
  [[nodiscard]] std::vector<Place> places(Rows rows, std::size_t size_here) const;

  /// Sends values to other ranks that have them: ghosts, and bonds between parts.
  void give_to_others(Rows rows, std::vector<double>& values) const;

  /// Numbers of the points that all ranks list, ascending; and the owned points of such numbers.
  [[nodiscard]] std::vector<Index> numbers_of_all(const std::vector<Index>& points) const;
  [[nodiscard]] std::vector<Index> points_here(const std::vector<Index>& numbers) const;

  /// Sets the pins: Rows::free_dofs are neither prescribed nor pinned.
  void pin(const FragmentPins& pins);

 private:
  /// Number of rows of the whole body and of this part, and of values per row. Further values of an
  /// array are the same on all ranks, or without meaning; rank 0 has the free generalised degrees
  /// of freedom (handles).
  struct Extent {
    std::int64_t whole = 0, here = 0, width = 1;
  };
  [[nodiscard]] Extent extent(Rows rows) const;
  /// Replaces Rows::histories by points or bonds.
  [[nodiscard]] Rows named(Rows rows) const {
    return rows == Rows::histories ? rows_of_histories_ : rows;
  }
  /// Numbers the free degrees of freedom, once for these pins.
  void number_free_dofs();
  void visit_rows(Rows rows, const std::function<void(std::int64_t, std::size_t)>& visit) const;
  void visit_bonds(const std::function<void(std::int64_t, std::size_t)>& visit) const;
  /// Bonds of an owned point that this rank reports, ascending by their other points.
  [[nodiscard]] std::vector<Offset> told_bonds(Index point) const;
  void give_to_ghosts(std::vector<double>& values, std::size_t width) const;
  void give_to_images(std::vector<double>& values) const;
  void give_bonds(std::vector<double>& values) const;

  const RecordedPoints& points_;
  const IndexMap& part_;
  const RowGathering& gathering_;
  const Bonds& bonds_;
  Rows rows_of_histories_;
  const std::vector<char>& prescribed_;
  std::vector<std::int64_t> first_bond_;  // of each owned point, in the whole body
  std::int64_t whole_bonds_ = 0;
  std::vector<char> pinned_;
  std::optional<std::vector<std::int64_t>> first_free_;  // likewise of free degrees of freedom
  std::vector<char> is_free_;                            // per degree of freedom of owned points
  std::int64_t whole_free_ = 0, free_here_ = 0;
};

}  // namespace peristat
