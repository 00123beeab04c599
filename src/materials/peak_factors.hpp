#pragma once

#include <array>
#include <vector>

#include "src/materials/bulk_pull.hpp"
#include "src/materials/strength_surface.hpp"
#include "src/potentials/any_law.hpp"

namespace peristat {

/// Largest stress that a body without flaws bears, over the stress at which its first bond starts
/// to fail: above 1, as others start later. Of stresses of a fixed ratio in a plane, by the angle
/// psi = atan2(s_b, s_a) of the largest principal stress and the largest other one; linear between
/// the angles that were computed.
class PeakFactors {
 public:
  /// @param law of the lattice's bonds under uniaxial tension
  /// @param surface of the largest stresses
  PeakFactors(const BulkPull& bulk, const AnyLaw& law, const StrengthSurface& surface);

  /// @param principal stresses, in any order [Pa]
  [[nodiscard]] double at(const std::array<double, 3>& principal) const;

 private:
  std::vector<double> factors_;  // at equal distances
};

}  // namespace peristat
