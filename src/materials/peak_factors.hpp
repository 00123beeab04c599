#pragma once

#include <array>
#include <vector>

#include "src/materials/bulk_pull.hpp"
#include "src/materials/material_strength.hpp"
#include "src/potentials/any_law.hpp"

namespace peristat {

/// What a strength surface makes of the law of a lattice's bonds, under stresses of a fixed ratio
/// in a plane, in the mean over directions.
///
/// The surface multiplies the onset of all bonds by chi. The work of the law stays, so that chi is
/// at most sqrt(2 M) / s_m, see OneLawOf::largest_onset. From the first bond's onset to the peak
/// the stress grows by a factor above 1, as other bonds start later, each at the onset that it has
/// then.
class PeakFactors {
 public:
  /// @param law of the bonds under uniaxial tension
  /// @param strength of the body, and the range of chi
  PeakFactors(const BulkPull& bulk, const AnyLaw& law, const MaterialStrength& strength);

  /// Factor from the onset to the peak, by the angle of the largest principal stress and the
  /// largest other one. It is linear between the angles of a table.
  /// @param principal stresses, in any order [Pa]
  [[nodiscard]] double at(const std::array<double, 3>& principal) const;

  /// A strength of the surface, and the one that the body has, which differs where the range of chi
  /// ends, and is infinite where the stress drives no bond.
  struct Strength {
    double asked = 0.0, reached = 0.0;  ///< multiples of the stresses
    double onset = 0.0;                 ///< where the first bond starts, likewise
  };
  [[nodiscard]] Strength strength(const std::array<double, 2>& stresses) const;

 private:
  /// chi without limits, and the factor with them.
  struct Onset {
    double chi = 1.0, factor = 1.0;
  };
  [[nodiscard]] Onset onset(const std::array<double, 2>& stresses) const;

  BulkPull bulk_;
  AnyLaw law_;
  MaterialStrength strength_;
  double uniaxial_ = 1.0;        // factor of the law itself
  std::vector<double> factors_;  // at equal distances
};

}  // namespace peristat
