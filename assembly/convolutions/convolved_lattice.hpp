#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "assembly/convolutions/cut_lattice.hpp"
#include "assembly/convolutions/lattice_springs.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// A lattice whose interactions are summed by convolutions, without stored bonds.
struct ConvolvedLattice {
  CutLattice box;
  std::size_t own = 0;  ///< number of points that are no images; they come first
  /// Springs to half the neighbours, one per opposite pair; for a solid, bonds of equivalent
  /// stiffness for its preconditioner.
  std::vector<LatticeSpring> springs;
  std::function<Bonds()> all_bonds{};  ///< finds the uncut bonds

  [[nodiscard]] bool has_images() const { return own < box.place.size(); }
};

}  // namespace peristat
