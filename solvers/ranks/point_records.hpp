#pragma once

#include "solvers/ranks/records.hpp"
#include "src/geometry/part.hpp"

namespace peristat {

/// Points as records: position, volume, cell, columns, number in the whole body, owner and sets.
class PointRecords {
 public:
  /// @param like a part whose dimension, spacing and names of sets the points share
  /// @throws std::logic_error for points with more than positions, volumes, a lattice's cells,
  ///         columns and sets
  explicit PointRecords(const Part& like);

  /// @param owner rank that owns the point from now on
  void add(const Part& part, Index point, int owner);
  [[nodiscard]] const Records& records() const { return records_; }

  /// Appends received points in ascending order: as this rank's own, or as ghosts after its own.
  void append_to(Part& part, const Records& received, bool as_ghosts) const;

 private:
  static constexpr int sets_per_number = 63;  // bits of a number without its sign

  Records records_;
  std::vector<std::vector<long long>> of_sets_;  // by point of `like`: numbers with a bit per set
  int dimension_;
  int corners_ = 0;  // of each point's cell; 0: none is known
  std::vector<std::string> names_;
};

/// A part without points, with the lattice and the names of sets of another one.
[[nodiscard]] Part empty_part(const Part& like);

}  // namespace peristat
