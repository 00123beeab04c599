#pragma once

#include <array>
#include <string>

#include "src/core/types.hpp"

namespace peristat {

/// Position of a crack's tip, and the ring about it over which its integrals are taken.
struct CrackTipSpecification {
  std::string name{};
  Coordinates at{};                  ///< of the tip, in 3D any point of its straight front [m]
  Coordinates direction{};           ///< in which the crack would go on, of any length
  Coordinates front{0.0, 0.0, 1.0};  ///< 3D: along the front, of any length
  /// Radii of the ring [m]; 0: 2 and 4 horizons. Of points with horizons of their own, the largest
  /// within the ring counts.
  double inner = 0.0, outer = 0.0;
  /// Length of a cut ahead of the tip, by which energy release rates are found [m]; 0: none.
  double cut = 0.0;
};

/// Loading of a crack's tip.
struct CrackTipValues {
  double j = 0.0;       ///< J integral [J/m2]
  double spread = 0.0;  ///< largest difference between J and that of a third of the ring, over J
  std::array<double, 3> k{};  ///< K_I, K_II, K_III [Pa m^1/2]
  double t_stress = 0.0;      ///< [Pa]
  /// T* = T sqrt(pi delta)/sqrt(K_I^2 + K_II^2), delta the horizon at the tip; 0 if both K are 0.
  double t_star = 0.0;
};

/// A plane frame at the tip: e1 ahead, e2 across the crack, e3 along the front.
struct CrackTipFrame {
  Coordinates origin{}, e1{}, e2{}, e3{};

  /// Components of the vector from the tip to a place.
  [[nodiscard]] Coordinates components(const Coordinates& place) const;
  [[nodiscard]] Coordinates vector(const Coordinates& components) const;
};

}  // namespace peristat
