#pragma once

#include "src/core/spacing.hpp"

namespace peristat {

/// Repair of the missing neighbours near surfaces; see make_bonds.
enum class SurfaceCorrection { none, volume, energy };

/// Lattice around points deep inside a body. A surface correction by energy changes their bonds,
/// too: it corrects the quadrature.
struct BulkLattice {
  Spacing spacing;
  double angle = 0.0;  ///< of its axes to x, y about z [degrees]
  SurfaceCorrection surface_correction = SurfaceCorrection::none;
};

}  // namespace peristat
