#pragma once

namespace peristat {

/// Least distance of Poisson's ratio from its limits, -1 and 1/2 (1 in the surface of cpd), as 1 +
/// nu and 1 - 2 nu (1 - nu). The shear and bulk moduli differ by a factor of about 1/(1 - 2 nu),
/// and where their forces cancel, as many digits are lost: measured, 50 eps/(1 - 2 nu) of
/// displacements, eps = 2.2e-16. The limit leaves seven digits.
inline constexpr double least_distance_of_poisson_ratio = 1e-7;

}  // namespace peristat
