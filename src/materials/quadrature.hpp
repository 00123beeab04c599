#pragma once

#include <span>
#include <vector>

#include "src/geometry/points.hpp"
#include "src/materials/bond_constants.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Norm of the vector between two points along the axes of their lattice; for a cloud along x, y, z
/// [m].
[[nodiscard]] double norm_between(const Points& points, Index i, Index j, HorizonShape shape);

/// Longest distance at which points may have a bond [m].
[[nodiscard]] double search_radius(const Points& points, const Kernel& kernel);

/// For points with horizons of their own, a radius for each: two of them may have a bond if their
/// distance is at most the larger radius [m].
[[nodiscard]] std::vector<double> search_radii(const Points& points, const Kernel& kernel);

/// Removes bonds of weight 0.
void drop_weightless(Bonds& bonds);

/// Finds the bonds of a body, unless its points have given neighbours, and sets their weights.
/// Bonds whose weight the kernel makes 0 are dropped. Bonds between two images have weight 0 and
/// are kept, since they are sides of triangles.
///
///   w_ij = 1/2 (V_i V_j nu_ij + V_j V_i nu_ji) omega_ij mu_ij   [m6]
///
/// nu is the kernel's partial volume or the given share, omega its influence and mu the surface
/// correction, all symmetric and frozen in the reference configuration:
///  - none:   mu = 1.
///  - volume: mu = 2 V_H / (V_i + V_j) with V_i = sum_j 1/2 (nu_ij + nu_ji) V_j and V_H that of a
///            point inside the lattice, for a cloud of points inside a lattice of the cloud's mean
///            spacing (Le and Bobaru 2018).
///  - energy: every point gets per axis a the factor g_a = classical / discrete energy density
///            under a confined unit strain along the axis, and a bond with direction n gets
///            mu = (sum_a (n_a / gbar_a)^2)^(-1/2), gbar the mean of its points' factors (Madenci
///            and Oterkus 2014, sec. 4.2). Iterating this until the corrected energies are
///            classical was tried: it makes bending softer again, not better.
///
/// Points with horizons of their own (Points::horizons) have bonds in two directions, i to j if
/// delta_i and j to i if delta_j reaches the other. With c(delta_i) the micromodulus of a horizon,
/// that of the setting the largest one, and nu_ij and omega_ij those of horizon delta_i,
///
///   w_ij = 1/2 V_i V_j (kappa_i nu_ij omega_ij + kappa_j nu_ji omega_ji) mu_ij,
///   kappa_i = c(delta_i) / c(delta) = (delta / delta_i)^(d+1).
[[nodiscard]] Bonds make_bonds(const Points& points, SurfaceCorrection surface,
                               const BondSetting& setting, int threads);

/// Volume that every point sees through its bonds, sum_j 1/2 (nu_ij + nu_ji) omega_ij V_j [m3]: for
/// a point inside a lattice that of whole_volumes. With horizons of points the two directions count
/// kappa_i nu_ij omega_ij and kappa_j nu_ji omega_ji. Images have that of their sources.
/// @param broken per bond, 1 if it does not count; empty: all count
[[nodiscard]] std::vector<double> seen_volumes(const Points& points, const Bonds& bonds,
                                               const Kernel& kernel, std::span<const char> broken);

/// The same of every point if it stood inside a lattice of its own size and horizon [m3].
[[nodiscard]] std::vector<double> whole_volumes(const Points& points, const Kernel& kernel);

/// Fineness of each bond, the kernel's horizon delta over the bond's own delta_ij; empty without
/// horizons of points. A bond fails as those of one horizon delta_ij do,
///
///   (w_i + w_j) / delta_ij = w_i / delta_i + w_j / delta_j,   w_i and w_j the terms of its weight.
///
/// The work W of a bond's law that follows from a fracture energy, G = c(delta) A(delta) W(delta),
/// is proportional to 1 / delta. So a bond releases what both of its directions would release.
[[nodiscard]] std::vector<double> fineness_of_bonds(const Points& points, const Bonds& bonds,
                                                    const Kernel& kernel);

/// Largest deviation from 1 of (discrete energy density / classical) over points and axes under a
/// confined unit strain: the error of the quadrature, or its rest after a surface correction.
[[nodiscard]] double confined_energy_error(const Points& points, const Bonds& bonds,
                                           const BondSetting& setting);

}  // namespace peristat
