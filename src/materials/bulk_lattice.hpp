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

/// Points of a cloud deep inside a body, with the correction of their bonds.
struct BulkCloud {
  double size = 0.0;  ///< mean size of the points whose horizon is the setting's [m]
  SurfaceCorrection surface_correction = SurfaceCorrection::none;
};

}  // namespace peristat
