#pragma once

#include <array>

namespace peristat {

/// Form of the surface on which stresses are strengths. Without one, a bond's stretch is decisive.
enum class StrengthCriterion { none, rankine, drucker_prager, mohr_coulomb };

/// Strength of an isotropic body under any stress, as a utilisation rho that is homogeneous of
/// degree 1 in the stress and 1 on the surface. With the principal stresses s_1 >= s_2 >= s_3,
/// I_1 their sum and J_2 the second invariant of their deviator,
///
///   Rankine         rho = max(s_1, 0) / f_t
///   Mohr, Coulomb   rho = max(s_1, 0) / f_t - min(s_3, 0) / f_c
///   Drucker, Prager rho = (sqrt(J_2) + g_1 I_1) / g_0,   g_0 = 2 f_c f_t / (sqrt(3) (f_c + f_t)),
///                                                        g_1 = (f_c - f_t) / (sqrt(3) (f_c +
///                                                        f_t)).
///
/// With Drucker and Prager the biaxial strength is 2 f_c f_t / (3 f_c - f_t), and that in shear
/// 2 f_c f_t / (sqrt(3) (f_c + f_t)).
struct StrengthSurface {
  StrengthCriterion criterion = StrengthCriterion::none;
  double tension = 0.0;      ///< f_t, uniaxial [Pa]
  double compression = 0.0;  ///< f_c, uniaxial [Pa]; not for Rankine. Negative or infinite with
                             ///< Drucker and Prager if no uniaxial compression is a strength

  /// @param principal stresses, in any order [Pa]
  /// @return rho; 0 or less: no multiple of the stress is a strength
  [[nodiscard]] double utilisation(const std::array<double, 3>& principal) const;
};

/// f_c of Drucker and Prager with this strength under equal biaxial tension: f_t f_b / (3 f_b -
/// 2 f_t). Negative for f_b < 2 f_t / 3.
/// @param biaxial f_b above f_t / 2 [Pa]
[[nodiscard]] double compressive_strength(double tension, double biaxial);

}  // namespace peristat
