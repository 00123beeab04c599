#pragma once

#include <memory>
#include <span>
#include <vector>

#include "assembly/energy/history.hpp"
#include "assembly/terms/model.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Damage that follows from a history.
struct DamageState {
  double dissipated_energy = 0.0;  ///< by degraded and broken bonds [J]
  Index broken_bonds = 0;
  double max_damage = 0.0;  ///< largest of a point
};

/// Damage of each point: the share of the weight of its bonds that is lost,
///
///   phi_i = 1 - sum_j w_ij T(kappa_ij) / (sum_j w_ij + c_i),
///
/// T the integrity that its history leaves to a bond and c_i the weight of the bonds that a
/// pre-crack has cut, which `cut_weight` gives where these are to count. With equal weights and T
/// either 0 or 1 this is one minus the share of unbroken bonds ([GPMB] eq. 13). A point without
/// bonds has the damage 0, or 1 if a crack has cut them.
/// @param cut_weight per point [m6], or empty
/// @param points those of the body: a bond across a plane of symmetry counts half, and its twin
///        counts the other half. On a part of a body sums are over the bonds that it counts, except
///        that the dissipation of failing points is that of the whole body; damage is right at the
///        points that its rank owns. Null: the body is whole and has no images
[[nodiscard]] DamageState assess_damage(const Model& model, const History& history,
                                        std::span<const double> cut_weight,
                                        std::span<double> damage, const Points* points = nullptr);

/// Largest stretch of each bond over the committed states, as far as it has damaged the bond (0
/// before, Degraded::never_fails where the model says so); empty for bonds that can't be damaged.
[[nodiscard]] std::span<const double> bond_stretches(const Model& model, const History& history);

/// True for each broken bond, in the order of the bonds; empty for bonds that can't break.
[[nodiscard]] std::vector<char> broken_bonds(const Model& model, const History& history);

/// All bonds of a body, and which of them are broken.
struct DamagedNetwork {
  std::shared_ptr<const Bonds> bonds;
  std::vector<char> broken;  ///< per bond; empty: none
};

/// The model's bonds; on a convolved lattice all of its bonds, found anew in each call.
[[nodiscard]] std::shared_ptr<const Bonds> whole_network(const Model& model);

/// Damaged network of all bonds of the body (whole_network).
[[nodiscard]] DamagedNetwork damaged_network(const Model& model, const History& history);

}  // namespace peristat
