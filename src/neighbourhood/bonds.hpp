#pragma once

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
};

}  // namespace peristat
