#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "solvers/problem/records.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// The histories of the bonds (bond_stretches) as a reader of the results knows them. Only
/// those that differ from 0 are kept: nearly all bonds of a body are never damaged.
class DamageHistories {
 public:
  /// The bonds whose history is another one than the reader knows; none without histories.
  [[nodiscard]] std::optional<BondHistories> changes(const Bonds& bonds,
                                                     std::span<const double> history) const;

  /// What the reader knows, of all bonds.
  [[nodiscard]] std::vector<double> told(Offset bonds) const;

  /// The reader knows this history now.
  void tell(std::span<const double> history);

 private:
  std::vector<std::pair<Offset, double>> known_;  // bond and largest stretch, ascending
};

}  // namespace peristat
