#pragma once

#include <array>
#include <utility>
#include <vector>

#include "src/geometry/lattice_box.hpp"

namespace peristat {

/// A lattice's box, and pairs of its points that do not interact.
struct CutLattice : LatticeBox {
  CutLattice() = default;
  CutLattice(LatticeBox box, std::vector<std::array<Index, 2>> pairs = {})
      : LatticeBox(std::move(box)), cut(std::move(pairs)) {}

  std::vector<std::array<Index, 2>> cut;  ///< pairs whose bonds pre-cracks have cut, each once
};

}  // namespace peristat
