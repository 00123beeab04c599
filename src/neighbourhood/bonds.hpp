#pragma once

#include <cstddef>
#include <vector>

#include "src/types.hpp"

namespace peristat {

/// Unique bonds i-j with i < j, grouped by their lower point: the partners of i are
/// partner[offset[i]] .. partner[offset[i+1]-1], ascending. The same graph is the sparsity pattern
/// of every tangent: triangles and tetrahedra have all mutual distances within the horizon.
struct Bonds {
  std::vector<Offset> offset;          ///< points + 1
  std::vector<Index> partner;          ///< upper point of each bond
  std::vector<double> inverse_length;  ///< 1/L, L the reference length: kernels divide by L [1/m]
  std::vector<double> weight;          ///< quadrature weight w of the bond's energy [m6]

  [[nodiscard]] double length(Offset bond) const { return 1.0 / inverse_length[bond]; }  ///< L [m]
  [[nodiscard]] Offset count() const { return static_cast<Offset>(partner.size()); }
  [[nodiscard]] Index points() const { return static_cast<Index>(offset.size()) - 1; }

  /// Removes every bond with drop(i, bond), i its lower point; the others keep their order. Each
  /// bond is asked for once, in order, before it moves: drop may read its partner, length and
  /// weight, but no offset.
  template <class Drop>
  void remove_if(const Drop& drop) {
    Offset kept = 0;
    Offset bond = 0;
    for (Index i = 0; i < points(); ++i) {
      const Offset end = offset[i + 1];
      for (; bond < end; ++bond) {
        if (drop(i, bond)) continue;
        partner[kept] = partner[bond];
        inverse_length[kept] = inverse_length[bond];
        weight[kept] = weight[bond];
        ++kept;
      }
      offset[i + 1] = kept;
    }
    partner.resize(std::size_t(kept));
    inverse_length.resize(std::size_t(kept));
    weight.resize(std::size_t(kept));
  }
};

}  // namespace peristat
