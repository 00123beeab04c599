#pragma once

#include <array>

#include "src/core/types.hpp"
#include "src/materials/bond_constants.hpp"

namespace peristat {

/// Micromodulus of bonds by the angle theta between their direction n and the fibres f,
///
///   c(n) = b_0 + b_1 t + b_2 t^2,  t = (n f)^2 = cos^2 theta  [N/m6]:
///
/// in 2D the harmonics 1, cos 2 theta and cos 4 theta.
struct DirectedConstant {
  std::array<double, 3> coefficients{};  ///< b_0, b_1, b_2; b_1 = b_2 = 0 without fibres
  Coordinates fibre{};                   ///< f, of length 1

  [[nodiscard]] double at(double t) const {
    return coefficients[0] + t * (coefficients[1] + t * coefficients[2]);
  }
  /// t of a direction of length 1.
  [[nodiscard]] double alignment(const Coordinates& n) const {
    const double cosine = n[0] * fibre[0] + n[1] * fibre[1] + n[2] * fibre[2];
    return cosine * cosine;
  }
  /// The least over all directions.
  [[nodiscard]] double least() const;
};

/// Moduli of a body with fibres [Pa]: Young's modulus along and across them, and the shear modulus
/// of planes that they lie in. Bonds alone have c_66 = c_12 (Cauchy), so that Poisson's ratio
/// follows.
struct FibreModuli {
  double along = 0.0, across = 0.0, shear = 0.0;
};

/// The shear modulus that makes the bonds of a body with along = across isotropic: sqrt(E_1 E_2)/(2
/// (1 + nu)) with their Poisson's ratio.
[[nodiscard]] double natural_shear(double along, double across, const BondSetting& setting);

/// Constants of given moduli in plane stress (2D) or 3D, transversely isotropic about the fibres.
/// With c_11 along the fibres, c_22 across and c_12 = c_66 = G:
///
///   plane stress  c_11 = (E_1 + sqrt(E_1^2 + 4 G^2 E_1/E_2))/2,  c_22 = c_11 E_2/E_1
///   3D            c_22 = 9/16 (E_2 + sqrt(E_2^2 + 16/9 G^2 E_2/E_1)),
///                 c_11 = E_1 + 3 G^2/(2 c_22),  c_23 = c_44 = c_22/3
///
/// (from 1/E = s_11, s the inverse of c), and b from the energy of homogeneous strains,
///
///   c_11 = m_1/2 <c t^2>,  c_22 = m_1/2 q <c (1-t)^2>,  c_12 = m_1/2 p <c t (1-t)>,
///
/// with the kernel's first moment m_1, means < > over all directions, q = p = 1 in 2D and q = 3/8,
/// p = 1/2 in 3D.
/// @param fibre of length 1
[[nodiscard]] DirectedConstant directed_micromodulus(const FibreModuli& moduli,
                                                     const Coordinates& fibre,
                                                     const BondSetting& setting);

/// Shear moduli, from the least to the largest, for which c(n) is positive in all directions; both
/// 0 if there are none.
[[nodiscard]] std::array<double, 2> possible_shear(const FibreModuli& moduli,
                                                   const BondSetting& setting);

}  // namespace peristat
