#pragma once

#include <optional>

#include "src/materials/bulk_lattice.hpp"
#include "src/neighbourhood/kernel.hpp"

namespace peristat {

/// State of a plane (2D) bond model.
enum class PlaneState { stress, strain };

/// Data that the constants of a bond-based model depend on besides the modulus.
struct BondSetting : Kernel {
  PlaneState plane = PlaneState::stress;  ///< 2D only
  std::optional<BulkLattice> lattice{};   ///< nothing for a cloud of points
  std::optional<BulkCloud> cloud{};       ///< nothing for a lattice, or the continuum
};

/// Micromodulus c [N/m6] of the bond force density c omega s for Young's modulus E [Pa], from the
/// kernel's first moment: under a confined unit strain along an axis a bond of direction n stores c
/// omega r n_x^4 / 2, half of it at each end, so that the classical energy e E per volume needs
///
///   c = 4 e E / (<n_x^4> m_1),   <n_x^4> = 1 | 3/8 | 1/5   in 1D | 2D | 3D.
///
/// With omega = 1 that is
///
///   1D 2E/(A d^2) | plane stress 9E/(pi d^3 h) | plane strain 48E/(5 pi d^3 h) | 3D 12E/(pi d^4)
///
/// (eq. 3 of [ADAPT], whose 1D constant has a pi too many: the energy of a bar under uniform
/// strain, c A d^2 / 4 per volume, must be E/2.)
[[nodiscard]] double micromodulus(double youngs_modulus, const BondSetting& setting);

/// The same for any first moment of the bonds [m4].
[[nodiscard]] double micromodulus(double youngs_modulus, const BondSetting& setting,
                                  double first_moment);

/// The same with the moment of a lattice: right in the mean over all directions of its axes.
[[nodiscard]] double lattice_micromodulus(double youngs_modulus, const BondSetting& setting,
                                          const Spacing& spacing);

/// Young's modulus that belongs to a micromodulus: the inverse of `micromodulus`.
[[nodiscard]] double youngs_modulus_of(double micromodulus, const BondSetting& setting);

/// Stretch at which brittle harmonic bonds break so that a plane crack takes the fracture energy
/// G [J/m2], from the kernel's second moment: the bonds over a unit of area hold
/// G = c s^2 / 2 * <|n_x|> m_2 / 2, so that
///
///   s_c = sqrt(4 G / (c <|n_x|> m_2)),   <|n_x|> = 1 | 2/pi | 1/2   in 1D | 2D | 3D.
///
/// With omega = 1 that is sqrt(10 G / (pi c d^5)) in 3D ([GPMB] eq. 10) and sqrt(4 G / (c h d^4))
/// in 2D.
[[nodiscard]] double critical_stretch(double fracture_energy, double micromodulus,
                                      const Kernel& kernel);

/// The same with the moment of a lattice: the mean over all directions of the crack.
[[nodiscard]] double lattice_critical_stretch(double fracture_energy, double micromodulus,
                                              const Kernel& kernel, const Spacing& spacing);

/// Mean of |n_x| over all directions: 1 | 2/pi | 1/2 in 1D | 2D | 3D.
[[nodiscard]] double mean_of_magnitude(int dimension);

/// Poisson's ratio that central forces impose: 1/3 in plane stress, 1/4 in plane strain and 3D,
/// 0 in 1D.
[[nodiscard]] double poisson_ratio(const BondSetting& setting);

/// Classical strain energy density per Young's modulus for a unit strain in one direction and none
/// in the others (laterally confined): 1D 1/2 | plane stress 9/16 | plane strain and 3D 3/5.
[[nodiscard]] double confined_energy_per_modulus(const BondSetting& setting);

}  // namespace peristat
