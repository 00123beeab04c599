#pragma once

namespace peristat {

/// State of a plane (2D) bond model.
enum class PlaneState { stress, strain };

/// What the constants of a bond-based model depend on besides the modulus.
struct BondSetting {
  int dimension = 2;
  PlaneState plane = PlaneState::stress;  ///< 2D only
  double horizon = 0.0;                   ///< delta [m]
  double cross_section = 1.0;             ///< 1D: area A [m2]; 2D: thickness h [m]; 3D: 1
};

/// Micromodulus c [N/m6] of the bond force density c s for Young's modulus E [Pa]:
///
///   1D 2E/(A d^2) | plane stress 9E/(pi d^3 h) | plane strain 48E/(5 pi d^3 h) | 3D 12E/(pi d^4)
///
/// (eq. 3 of [ADAPT], whose 1D constant has a pi too many: the energy of a bar under uniform
/// strain, c A d^2 / 4 per volume, must be E/2.)
[[nodiscard]] double micromodulus(double youngs_modulus, const BondSetting& setting);

/// Young's modulus that belongs to a micromodulus: the inverse of the above.
[[nodiscard]] double youngs_modulus_of(double micromodulus, const BondSetting& setting);

/// Poisson's ratio that central forces impose: 1/3 in plane stress, 1/4 in plane strain and 3D,
/// 0 in 1D.
[[nodiscard]] double poisson_ratio(const BondSetting& setting);

/// Classical strain energy density per Young's modulus for a unit strain in one direction and none
/// in the others (laterally confined): 1D 1/2 | plane stress 9/16 | plane strain and 3D 3/5.
[[nodiscard]] double confined_energy_per_modulus(const BondSetting& setting);

}  // namespace peristat
