#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "src/materials/material_strength.hpp"
#include "src/materials/peak_factors.hpp"

namespace peristat {

/// A strength, and the factors from the first onset to the peak; null: 1.
struct PointStrength {
  MaterialStrength of;
  std::shared_ptr<const PeakFactors> peak_factors{};
};

/// Rule by which bonds start to fail where the stress of their points reaches a strength surface.
///
/// The utilisation rho_i of a point follows from its elastic stress C : eps_i, times the factor by
/// which the stress grows from the first bond's onset to its peak. One of the point's bonds has
/// the largest (equivalent) stretch m_i, which is m_i / rho_i at the strength, however the stress
/// is composed. A bond of the onset s_m starts at
///
///   chi s_m,   chi = (chi_i + chi_j) / 2,   chi_i = m_i / (rho_i s_m),
///
/// so that under a homogeneous stress the bond that is stretched most starts exactly at rho = 1, on
/// any lattice and in any direction. chi_i is kept within a range, and is its upper end where
/// rho_i <= 0. With chi s_m as the onset the law gets the critical stretch with which its work M is
/// what it was: the fracture energy is that of the law. That needs M >= (chi s_m)^2 / 2.
///
/// At points at which a bond has started chi_i is at most 1, so that cracks run at their fracture
/// energy.
///
/// chi is found anew in accepted states until a bond starts, and is constant from then on. As it is
/// homogeneous of degree 0 in the load, steps do not matter while the stress grows in proportion.
class StrengthOnsets {
 public:
  /// @param of_point number of its material per point; empty: the first one
  /// @param factor of each point's strength; empty: 1
  StrengthOnsets(std::vector<std::optional<PointStrength>> materials,
                 std::vector<std::uint8_t> of_point, std::vector<double> factor)
      : materials_(std::move(materials)),
        of_point_(std::move(of_point)),
        factor_(std::move(factor)) {}

  /// What the bonds of a point start by.
  struct PointOnset {
    double stretch = 0.0;                           ///< m_i / rho_i; infinite for rho_i <= 0
    std::optional<std::array<double, 2>> factor{};  ///< none: chi_i is 1
    /// chi_i s_m of a bond.
    [[nodiscard]] double of_bond(double onset, double most_of_law) const;
  };

  /// @param displacement_gradient F - I, D x D entries, row major
  /// @param free stress-free stretch
  /// @param largest_stretch m_i
  [[nodiscard]] PointOnset of_point(std::size_t point, int dimension,
                                    const double* displacement_gradient, double free,
                                    double largest_stretch) const;

 private:
  std::vector<std::optional<PointStrength>> materials_;
  std::vector<std::uint8_t> of_point_;
  std::vector<double> factor_;
};

}  // namespace peristat
