#pragma once

#include <optional>

#include "cases/runner/commands/run.hpp"
#include "cases/runner/input/case.hpp"
#include "src/materials/cpd_constants.hpp"

namespace peristat {

/// Lattice, and what is known of the material: E and nu, or lambda and mu, or C1 to C3.
struct CalibrationQuestion {
  int dimension = 0;
  double spacing = 0.0;        ///< [m]
  double horizon_ratio = 0.0;  ///< horizon / spacing
  double thickness = 1.0;      ///< 2D [m]
  std::optional<double> youngs_modulus, poisson_ratio, lambda, mu, c1, c2, c3;
};

/// Prints constants and moduli, in the continuum and on the lattice's bulk sums, as JSON.
/// @throws InputError with the command line's options as keys
[[nodiscard]] Exit calibrate(const CalibrationQuestion& question);

/// The same for the lattice and material of a case of model "cpd".
[[nodiscard]] Exit calibrate(const Case& from);

}  // namespace peristat
