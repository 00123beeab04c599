#pragma once

#include "src/neighbourhood/kernel.hpp"

namespace peristat {

/// Constants of the harmonic potentials of one-, two- and three-neighbour interactions
/// (eqs. 23-25 of [CPD]): C1 [N/m6], C2 [N/m10], C3 [N/m14]. C3 is 0 in 2D.
struct CpdConstants {
  double c1 = 0.0, c2 = 0.0, c3 = 0.0;
};

/// Lamé's moduli of isotropic elasticity [Pa]. In 2D those of a surface, in which nothing exists
/// outside the plane ([CPD] remark 1): nu = lambda / (lambda + 2 mu), neither plane stress nor
/// plane strain.
struct LameModuli {
  double lambda = 0.0, mu = 0.0;
};

[[nodiscard]] double youngs_modulus_of(const LameModuli& moduli, int dimension);
[[nodiscard]] double poisson_ratio_of(const LameModuli& moduli, int dimension);

/// @throws InputError (key "youngs_modulus" or "poisson_ratio") outside the range of stable bodies,
///         E > 0 and -1 < nu < 1 (2D) or 1/2 (3D)
[[nodiscard]] LameModuli lame_moduli(double youngs_modulus, double poisson_ratio, int dimension);

/// @throws InputError (key "lambda" or "mu") outside the same range: mu > 0, lambda + mu > 0 (2D),
///         lambda + 2 mu / 3 > 0 (3D)
void require_stable(const LameModuli& moduli, int dimension);

/// Elastic constants of a cubic lattice [Pa].
struct CubicElasticity {
  double c11 = 0.0, c12 = 0.0, c44 = 0.0;

  /// Zener's ratio 2 c44 / (c11 - c12): 1 for an isotropic body.
  [[nodiscard]] double anisotropy() const { return 2.0 * c44 / (c11 - c12); }

  /// Poisson's ratio for a pull along an axis of the lattice: c12 / c11 in 2D, c12 / (c11 + c12) in
  /// 3D.
  [[nodiscard]] double axis_poisson_ratio(int dimension) const {
    return c12 / (dimension == 2 ? c11 : c11 + c12);
  }

  /// Isotropic part, the mean over all directions of the axes (Voigt).
  [[nodiscard]] LameModuli isotropic(int dimension) const;
};

/// Elasticity of a point far from surfaces under small homogeneous strains: linear in the
/// constants, with one term for each kind of interaction.
struct CpdStiffness {
  int dimension = 2;
  CubicElasticity of_c1, of_c2, of_c3;  ///< per unit of the constant [Pa/(N/m6)], …

  [[nodiscard]] CubicElasticity elasticity(const CpdConstants& constants) const;
  [[nodiscard]] LameModuli moduli(const CpdConstants& constants) const {
    return elasticity(constants).isotropic(dimension);
  }

  /// Constants for given moduli. In 2D they determine C1 and C2; in 3D C2 is free.
  /// @throws InputError (key "poisson_ratio") if the horizon is too short for the interactions that
  ///         it needs, and (key "c2") if C1 would not be positive: one-neighbour interactions are
  ///         what makes a body stable ([CPD] sec. 4.4)
  [[nodiscard]] CpdConstants constants(const LameModuli& moduli, double c2) const;
};

/// Stiffness of the continuum with balls as neighbourhoods:
///
///   2D  mu = pi d^3 h C1 / 24,  lambda - mu = 5 pi^2 / (9 (4 pi - 3 sqrt 3)) d^6 h^2 C2
///   3D  mu = pi d^4 C1 / 30 + 0.139553047382 d^8 C2,
///       lambda = pi d^4 C1 / 30 + 0.837318284291 d^8 C2 + 1.81517547 d^12 C3
///
/// The energy density (eq. 14 of [CPD]) under a strain e is C1/4 int L (n.e n)^2 +
/// C2/6 V_H^2 <A (P:e)^2> + C3/8 V_H^3 <V> (tr e)^2 with means < > over contributing pairs and
/// triplets, P the identity of the triangle's plane.
/// @param cross_section thickness h in 2D [m]
[[nodiscard]] CpdStiffness continuum_stiffness(int dimension, double horizon, double cross_section);

/// Stiffness of the lattice: the same energy density with the sums over neighbours, pairs and
/// triplets and their effective volumes in place of the integrals. Differs from the continuum's by
/// up to a factor of two, and is not isotropic.
[[nodiscard]] CpdStiffness lattice_stiffness(int dimension, double spacing, double horizon,
                                             double cross_section);
/// The same with the influence function of a kernel.
[[nodiscard]] CpdStiffness lattice_stiffness(const Kernel& kernel, double spacing);

}  // namespace peristat
