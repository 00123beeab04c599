#pragma once

#include <vector>

#include "src/core/spacing.hpp"
#include "src/core/types.hpp"
#include "src/neighbourhood/lattice_kernel.hpp"

namespace peristat {

/// Stiffness of the bond between two points of a lattice at rest.
struct LatticeSpring {
  LatticeStep step{};       ///< from one point to the other, along the lattice's axes
  Coordinates direction{};  ///< n, unit vector along it in the axes of the body
  Coordinates arm{};        ///< xi, the vector itself [m]
  double stiffness = 0.0;   ///< k [N/m]
};

/// A step to a neighbour, and its share.
struct LatticeArm {
  LatticeStep step{};  ///< along the lattice's axes
  Coordinates xi{};    ///< the same in the axes of the body [m]
  double share = 0.0;  ///< kappa = V^2 nu omega [m6]
};

/// The harmonic bonds of a point of a lattice, linearised at rest: energy k (n.(u' - u))^2 / 2 with
///
///   k = c w / r,   w = V^2 nu omega,
///
/// one per opposite pair. Weights are those that make_bonds gives without a surface correction.
/// @param angle of the lattice's axes to x and y about z [degrees]
/// @param micromodulus c [N/m6]
/// @param volume V of each point [m3]
[[nodiscard]] std::vector<LatticeSpring> lattice_springs(const Kernel& kernel,
                                                         const Spacing& spacing, double angle,
                                                         double micromodulus, double volume);

/// The neighbours of a point of a lattice, one per opposite pair, with shares from the kernel's
/// influence omega and partial volumes nu.
[[nodiscard]] std::vector<LatticeArm> lattice_arms(const Kernel& kernel, const Spacing& spacing,
                                                   double angle, double volume);

}  // namespace peristat
