#pragma once

#include "src/geometry/points.hpp"
#include "src/materials/bond_constants.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Part of a neighbour's volume that counts: all of it, or a share that falls linearly from 1 to 0
/// while the distance runs over one spacing about the horizon.
enum class VolumeCorrection { none, linear };

/// Repair of the missing neighbours near surfaces; see make_bonds.
enum class SurfaceCorrection { none, volume, energy };

struct Quadrature {
  VolumeCorrection volume = VolumeCorrection::none;
  SurfaceCorrection surface = SurfaceCorrection::none;
};

/// Share nu of a point's volume inside another's horizon, for the linear correction:
/// (delta + D/2 - r) / D between delta - D/2 and delta + D/2, 1 below, 0 above
/// (r distance, D size of the volume).
[[nodiscard]] double linear_partial_volume(double distance, double horizon, double size);

/// Radius that the neighbour search needs [m]: the horizon, and half the largest volume's size more
/// with the linear volume correction.
[[nodiscard]] double search_radius(const Points& points, const Quadrature& quadrature,
                                   const BondSetting& setting);

/// Finds the bonds of a body and sets their weights; bonds of weight zero are dropped.
///
///   w_ij = 1/2 (V_i V_j nu_ij + V_j V_i nu_ji) mu_ij   [m6]
///
/// nu is the partial volume and mu the surface correction, both symmetric and frozen in the
/// reference configuration:
///  - none:   mu = 1.
///  - volume: mu = 2 V_H / (V_i + V_j) with V_i = sum_j 1/2 (nu_ij + nu_ji) V_j and V_H that of a
///            point inside the lattice, for a cloud of points inside a lattice of the cloud's mean
///            spacing (Le and Bobaru 2018).
///  - energy: every point gets per axis a the factor g_a = classical / discrete energy density
///            under a confined unit strain along the axis, and a bond with direction n gets
///            mu = (sum_a (n_a / gbar_a)^2)^(-1/2), gbar the mean of its points' factors (Madenci
///            and Oterkus 2014, sec. 4.2). Iterating this until the corrected energies are
///            classical was tried: it makes bending softer again, not better.
[[nodiscard]] Bonds make_bonds(const Points& points, const Quadrature& quadrature,
                               const BondSetting& setting, int threads);

/// Largest deviation from 1 of (discrete energy density / classical) over points and axes under a
/// confined unit strain: the error of the quadrature, and what a surface correction leaves of it.
[[nodiscard]] double confined_energy_error(const Points& points, const Bonds& bonds,
                                           const BondSetting& setting);

}  // namespace peristat
