#pragma once

#include <span>
#include <utility>
#include <vector>

#include "solvers/observe/recorded_points.hpp"
#include "solvers/problem/records.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Histories of the bonds (bond_stretches) as last written to the results. Only those that differ
/// from 0 are kept: nearly all bonds of a body are never damaged.
class DamageHistories {
 public:
  /// Bonds whose history differs from the one last written. Leaves out bonds between two images,
  /// which repeat others, and bonds that another rank reports.
  [[nodiscard]] BondHistories changes(const RecordedPoints& points, const Bonds& bonds,
                                      std::span<const double> history) const;

  /// Last written histories of all bonds.
  [[nodiscard]] std::vector<double> told(Offset bonds) const;

  /// Notes a history as written.
  void tell(std::span<const double> history);

 private:
  std::vector<std::pair<Offset, double>> known_;  // bond and largest stretch, ascending
};

}  // namespace peristat
