#pragma once

#include "src/materials/bond_constants.hpp"

namespace peristat {

/// Lame's constants [Pa]. In plane stress lambda is that of the plane, E nu / (1 - nu^2), so that
/// stress = lambda tr(strain) 1 + 2 mu strain with traces in the plane.
struct LamePair {
  double lambda = 0.0, mu = 0.0;
};

/// @param plane 2D only
[[nodiscard]] LamePair lame_constants(double youngs_modulus, double poisson_ratio, int dimension,
                                      PlaneState plane);

/// Energy that a linear peridynamic solid with the kernel 1/r loses per area of a plane crack under
/// a uniform dilation by s, over s^2 [J/m2]: the energy of all bonds that cross it,
///
///   d (d (lambda - mu) / 2 + (d + 2) mu / 2) (1/m) int r |xi_n| dV = 3 delta (lambda + mu) / pi |
///   delta (9 lambda + 6 mu) / 5   in 2D | 3D
///
/// ([LPS] eq. 6.2 with beta' = beta; in 3D that of bonds of the same bulk modulus.)
[[nodiscard]] double crack_energy_of_dilation(const LamePair& constants, double horizon,
                                              int dimension);

/// The same with a kernel K(r) of any form:
///
///   d (d lambda + 2 mu) / 2  <|n_x|> int K r^3 dV / int K r^2 dV,   <|n_x|> = 2/pi | 1/2.
///
/// Every bond counts with its equal share of the dilatations of its points: together the bonds hold
/// this energy as long as there is no crack.
/// @param of_bonds with the influence K(r) r / delta
[[nodiscard]] double crack_energy_of_dilation(const LamePair& constants, const Kernel& of_bonds);

}  // namespace peristat
