#pragma once

#include <memory>
#include <string>

#include "solvers/formulations/specification/body_specification.hpp"
#include "src/materials/bulk_pull.hpp"
#include "src/materials/cpd_tear.hpp"

namespace peristat {

/// Data from which a fracture energy and a strength give stretches of bonds.
struct FractureScale {
  double youngs_modulus = 0.0;  ///< E [Pa]
  double micromodulus = 0.0;    ///< c, or C1 of cpd [N/m6]
  double crossing = 0.0;        ///< A of the bonds [m5], see BulkBonds
  double spacing = 0.0;         ///< [m], for messages
  /// For cpd: by stretch with a horizon up to largest_ratio_of_tear; by release that of the bonds
  /// alone, which take it all. Null otherwise.
  std::shared_ptr<const CpdTear> tear{};
  /// For bonds and states; for cpd by stretch if there is a `tear` and it is quickly computed.
  std::shared_ptr<const BulkPull> pull{};

  /// Fracture energy G of a law, the mean over all directions of a tear [J/m2].
  [[nodiscard]] double energy(const DamageSpecification& damage) const;
  /// Strength f_t of a law, the mean over the directions of a pull [Pa]; 0 for a lattice without
  /// shear stiffness, infinite if a pull fails no bond.
  [[nodiscard]] double strength(const DamageSpecification& damage) const;
};

/// Returns the law with stretches in the place of fracture energy and strength. With the work W =
/// int_0^s_c f ds of a bond's force c f(s) and its largest value f_p
///
///   G = c A W,
///
/// and f_t is the largest stress of the bulk under a pull, see BulkPull: from about E f_p of
/// brittle bonds to 1.5 E f_p of tough ones (2D), because bonds oblique to the pull soften later.
///
/// A law that softens, given by a fracture energy alone, has as onset half the stretch of a brittle
/// bond of the same energy (blended: a quarter, and a peak force of half). In cpd by stretch G is
/// that of a CpdTear: c A is replaced by the G/W of the law that is found, and the brittle bond is
/// one of the same W. A table has its own onset and critical stretch.
/// @param key of the material, for errors
/// @throws InputError ("material.damage.strength", …) if there are no such stretches, with the
///         largest spacing that has them
[[nodiscard]] DamageSpecification with_stretches(const DamageSpecification& damage,
                                                 const std::string& key,
                                                 const FractureScale& scale);

/// Steps from one horizon to half of it in DamageSpecification::of_horizons, which has the
/// stretches of the body's horizon times 2^(-k / horizon_steps) in entry k.
inline constexpr int horizon_steps = 16;

/// Stretches of bonds whose horizon is the body's over `fineness`, of a law by its fracture energy.
/// G / (c A) = W is proportional to 1 / horizon, and so are squared stretches if the shape of the
/// law is the same: with G alone. With a strength or onset beside G it is not. Then logarithms of
/// stretches are interpolated linearly: within 1e-4 of those of the very horizon.
/// @param fineness from 1 to that of the last entry
[[nodiscard]] LawStretches stretches_of(const DamageSpecification& damage, double fineness);

/// W of the whole law, for the modulus 1: c A W is the fracture energy of bonds.
[[nodiscard]] double total_work(const DamageSpecification& damage);

/// f_p, the largest force for the modulus 1.
[[nodiscard]] double peak_force(const DamageSpecification& damage);

/// Largest spacing at the same horizon ratio with which a law of this kind can have both this
/// strength and this fracture energy: there it is brittle, or as steep as an OpeningLaw can be [m].
[[nodiscard]] double largest_spacing(const DamageSpecification& damage, double fracture_energy,
                                     double strength, const FractureScale& scale);

/// W_c = G_c / (2 delta), the energy density at which points fail ([FCBM] eq. 21) [J/m3].
[[nodiscard]] double bearable_energy_density(const DamageSpecification& damage, double horizon);

}  // namespace peristat
