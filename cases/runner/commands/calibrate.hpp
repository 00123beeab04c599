#pragma once

#include <cstdio>
#include <optional>

#include "cases/runner/commands/run.hpp"
#include "cases/runner/input/case.hpp"
#include "src/materials/cpd_constants.hpp"

namespace peristat {

/// Lattice and given constants of the material: E and nu, or lambda and mu, or C1 to C3.
struct CalibrationQuestion {
  int dimension = 0;
  double spacing = 0.0;        ///< [m]
  double horizon_ratio = 0.0;  ///< horizon / spacing
  double thickness = 1.0;      ///< 2D [m]
  std::string influence = ConstantInfluence::name;
  bool with_strengths = false;  ///< see bond_calibration
  std::optional<double> youngs_modulus, poisson_ratio, lambda, mu, c1, c2, c3;
};

/// Further data for models "bond" and "state": corrections, and a material with its law of damage.
struct BondCalibrationQuestion {
  double area = 1.0;   ///< 1D [m2]
  double angle = 0.0;  ///< of the lattice, on which a correction by energy depends [degrees]
  VolumeCorrection volume_correction = VolumeCorrection::none;
  HorizonShape horizon_shape = HorizonShape::ball;
  SurfaceCorrection surface_correction = SurfaceCorrection::none;
  MaterialSpecification material{};
};

/// Prints constants and moduli, of the continuum and of the lattice's bulk sums, as JSON; with a
/// law of damage also fracture energies and strengths on the lattice.
/// @throws InputError with the command line's options as keys
[[nodiscard]] Exit calibrate(const CalibrationQuestion& question,
                             const DamageSpecification& damage);

/// Prints constants of bonds or states, see bond_calibration, as JSON.
/// @param where dimension, spacing, horizon ratio, thickness, Young's modulus and, of states,
///        Poisson's ratio
/// @throws InputError with the command line's options as keys
[[nodiscard]] Exit calibrate(const CalibrationQuestion& where, BondCalibrationQuestion question);

/// Prints the calibration for the lattice and materials of a case.
[[nodiscard]] Exit calibrate(const Case& from, bool with_strengths, std::FILE* out = stdout);

}  // namespace peristat
