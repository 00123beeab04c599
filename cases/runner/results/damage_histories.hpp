#pragma once

#include <span>
#include <utility>
#include <vector>

#include "cases/runner/build/recorded_points.hpp"
#include "solvers/problem/records.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// The histories of the bonds (bond_stretches) as a reader of the results knows them. Only
/// those that differ from 0 are kept: nearly all bonds of a body are never damaged.
class DamageHistories {
 public:
  /// The bonds whose history is another one than the reader knows. Bonds between two images, which
  /// repeat others, are left out, and those that another rank tells.
  [[nodiscard]] BondHistories changes(const RecordedPoints& points, const Bonds& bonds,
                                      std::span<const double> history) const;

  /// What the reader knows, of all bonds.
  [[nodiscard]] std::vector<double> told(Offset bonds) const;

  /// The reader knows this history now.
  void tell(std::span<const double> history);

 private:
  std::vector<std::pair<Offset, double>> known_;  // bond and largest stretch, ascending
};

}  // namespace peristat
