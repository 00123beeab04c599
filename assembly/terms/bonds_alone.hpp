#pragma once

#include <span>

#include "assembly/energy/evaluation.hpp"
#include "assembly/terms/bond_drive.hpp"
#include "assembly/terms/failure/bond_failure.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Damages bonds by release of a body in which nothing but their own stretches drives them: they
/// share nothing, so that their order does not matter. Returns the damage.
/// @param drives of all bonds
DamageGrowth damage_bonds_alone(const BondFailure& bonds, const Points& points,
                                std::span<const BondDrive> drives, std::span<double> history);

/// Damage that this would do.
[[nodiscard]] DamageGrowth growth_of_bonds_alone(const BondFailure& bonds, const Points& points,
                                                 std::span<const BondDrive> drives,
                                                 std::span<const double> history);

}  // namespace peristat
