#pragma once

#include <array>

#include "src/materials/lame_constants.hpp"
#include "src/materials/strength_surface.hpp"

namespace peristat {

/// Strength of an isotropic material under any stress, and the elastic response with which strains
/// reach it.
struct MaterialStrength {
  StrengthSurface surface;  ///< of the largest stresses
  int dimension = 2;
  LamePair elastic;
  double across = 0.0;             ///< in plane strain Poisson's ratio, otherwise 0
  std::array<double, 2> factor{};  ///< range of a bond's onset over that of its law

  /// Principal elastic stresses of principal strains, of which 2D has the first two [Pa].
  [[nodiscard]] std::array<double, 3> stresses(const std::array<double, 3>& strains) const;
  /// rho of these.
  [[nodiscard]] double utilisation(const std::array<double, 3>& strains) const {
    return surface.utilisation(stresses(strains));
  }
};

}  // namespace peristat
