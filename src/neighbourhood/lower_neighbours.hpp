#pragma once

#include <vector>

#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Neighbours below each point, which bonds do not store: those of i are point[offset[i]] ..
/// point[offset[i+1]-1], ascending.
struct LowerNeighbours {
  std::vector<Offset> offset;  ///< points + 1
  std::vector<Index> lower;
  std::vector<Offset> bond;  ///< bond to each of these

  explicit LowerNeighbours(const Bonds& bonds);

  /// Calls visit(neighbour, bond) for all neighbours of a point, ascending.
  template <class Visit>
  void for_each_neighbour(const Bonds& bonds, Index i, const Visit& visit) const {
    for (Offset e = offset[i]; e < offset[i + 1]; ++e) visit(lower[e], bond[e]);
    for (Offset b = bonds.offset[i]; b < bonds.offset[i + 1]; ++b) visit(bonds.partner(i, b), b);
  }

  [[nodiscard]] double bytes() const {
    return double(sizeof(Offset)) * double(offset.size() + bond.size()) +
           double(sizeof(Index)) * double(lower.size());
  }
};

}  // namespace peristat
