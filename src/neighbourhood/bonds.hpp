#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "src/core/types.hpp"
#include "src/neighbourhood/bond_kinds.hpp"

namespace peristat {

/// Points of a bond, the lower one first.
using BondEnds = std::array<Index, 2>;

/// Unique bonds i-j with i < j, grouped by their lower point: the partners of i are
/// partner[offset[i]] .. partner[offset[i+1]-1], ascending. The same graph is the sparsity pattern
/// of every tangent: triangles and tetrahedra have all mutual distances within the horizon.
struct Bonds {
  std::vector<Offset> offset;  ///< points + 1
  std::vector<Index> partner;  ///< upper point of each bond
  BondKinds kind;

  [[nodiscard]] double inverse_length(Offset bond) const { return kind[bond].inverse_length; }
  [[nodiscard]] double length(Offset bond) const { return 1.0 / inverse_length(bond); }  ///< L [m]
  [[nodiscard]] double weight(Offset bond) const { return kind[bond].weight; }
  [[nodiscard]] Offset count() const { return static_cast<Offset>(partner.size()); }
  [[nodiscard]] Index points() const { return static_cast<Index>(offset.size()) - 1; }

  /// The bond between two points.
  [[nodiscard]] std::optional<Offset> find(Index one, Index other) const {
    const auto [lower, upper] = std::minmax(one, other);
    const auto first = partner.begin() + offset[std::size_t(lower)];
    const auto last = partner.begin() + offset[std::size_t(lower) + 1];
    const auto found = std::lower_bound(first, last, upper);
    if (found == last || *found != upper) return std::nullopt;
    return Offset(found - partner.begin());
  }

  /// Removes every bond with drop(i, bond), i its lower point; the others keep their order. Calls
  /// drop once per bond, in order, before the bond moves: it may read the bond's partner, length
  /// and weight, but no offset.
  template <class Drop>
  void remove_if(const Drop& drop) {
    Offset kept = 0;
    Offset bond = 0;
    for (Index i = 0; i < points(); ++i) {
      const Offset end = offset[i + 1];
      for (; bond < end; ++bond) {
        if (drop(i, bond)) continue;
        partner[kept] = partner[bond];
        kind.copy(bond, kept);
        ++kept;
      }
      offset[i + 1] = kept;
    }
    partner.resize(std::size_t(kept));
    kind.truncate(kept);
  }

  /// Gives every bond the weight weight_of(i, bond), i its lower point; called in order.
  template <class WeightOf>
  void set_weights(const WeightOf& weight_of) {
    ReweighedKinds weighted(kind);
    for (Index i = 0; i < points(); ++i) {
      for (Offset bond = offset[i]; bond < offset[i + 1]; ++bond) {
        weighted.push_back(weight_of(i, bond));
      }
    }
    kind = weighted.take();
  }
};

}  // namespace peristat
