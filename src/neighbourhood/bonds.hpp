#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "src/core/types.hpp"
#include "src/neighbourhood/bond_kinds.hpp"
#include "src/neighbourhood/partners.hpp"

namespace peristat {

/// Points of a bond, the lower one first.
using BondEnds = std::array<Index, 2>;

/// Unique bonds i-j with i < j, grouped by their lower point: those of i are offset[i] ..
/// offset[i+1]-1, by ascending partners. The same graph is the sparsity pattern of every tangent:
/// triangles and tetrahedra have all mutual distances within the horizon.
struct Bonds {
  std::vector<Offset> offset;  ///< points + 1
  Partners partner;            ///< partner(i, bond): upper point of a bond of point i
  BondKinds kind;

  [[nodiscard]] double inverse_length(Offset bond) const { return kind[bond].inverse_length; }
  [[nodiscard]] double length(Offset bond) const { return 1.0 / inverse_length(bond); }  ///< L [m]
  [[nodiscard]] double weight(Offset bond) const { return kind[bond].weight; }
  [[nodiscard]] Offset count() const { return partner.size(); }
  [[nodiscard]] Index points() const { return static_cast<Index>(offset.size()) - 1; }
  /// Partners of point i.
  [[nodiscard]] PartnersOfPoint of(Index i) const {
    return partner.between(i, offset[i], offset[i + 1]);
  }

  /// The bond between two points.
  [[nodiscard]] std::optional<Offset> find(Index one, Index other) const {
    const auto [lower, upper] = std::minmax(one, other);
    const std::optional<Offset> place = of(lower).place_of(upper);
    if (!place) return std::nullopt;
    return offset[std::size_t(lower)] + *place;
  }

  /// Removes every bond with drop(i, bond), i its lower point; the others keep their order. Calls
  /// drop once per bond, in order, before the bond moves: it may read the bond's partner, length
  /// and weight, but no offset.
  template <class Drop>
  void remove_if(const Drop& drop) {
    PartnersBuilder left;
    std::vector<Index> row;
    Offset kept = 0;
    Offset bond = 0;
    for (Index i = 0; i < points(); ++i) {
      const Offset end = offset[i + 1];
      row.clear();
      for (; bond < end; ++bond) {
        if (drop(i, bond)) continue;
        row.push_back(partner(i, bond));
        kind.copy(bond, kept);
        ++kept;
      }
      left.add(row);
      offset[i + 1] = kept;
    }
    partner = left.take();
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
