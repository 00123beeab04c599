#pragma once

#include <array>
#include <string>

#include "src/core/types.hpp"

namespace peristat {

/// Where a crack ends, and the ring about it over which its integrals are taken.
struct CrackTipSpecification {
  std::string name{};
  Coordinates at{};                  ///< of the tip, in 3D any point of its straight front [m]
  Coordinates direction{};           ///< in which the crack would go on, of any length
  Coordinates front{0.0, 0.0, 1.0};  ///< 3D: along the front, of any length
  /// Radii of the ring [m]; 0: 2 and 4 horizons.
  double inner = 0.0, outer = 0.0;
  /// Length of a cut ahead that energy release rates are found by [m]; 0: none.
  double cut = 0.0;
};

/// What loads the tip of a crack.
struct CrackTipValues {
  double j = 0.0;       ///< J integral [J/m2]
  double spread = 0.0;  ///< largest difference between J and that of a third of the ring, over J
  std::array<double, 3> k{};  ///< K_I, K_II, K_III [Pa m^1/2]
  double t_stress = 0.0;      ///< [Pa]
};

/// A plane frame at the tip: e1 ahead, e2 across the crack, e3 along the front.
struct CrackTipFrame {
  Coordinates origin{}, e1{}, e2{}, e3{};

  /// Components of a vector from the tip.
  [[nodiscard]] Coordinates components(const Coordinates& place) const;
  [[nodiscard]] Coordinates vector(const Coordinates& components) const;
};

}  // namespace peristat
