#pragma once

#include "assembly/terms/points/point_term.hpp"
#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// Setting of the bonds that a convolved body stores: short ones alone, to the next neighbours
/// along the axes and the diagonals of planes.
[[nodiscard]] BondSetting setting_of_short_bonds(const Points& points, BondSetting setting);

/// Refuses bodies whose forces are no convolution over a lattice.
/// @throws InputError ("force_operator")
void require_convolutions(const BodySpecification& from, const Points& points);

/// The operator that a formulation has beside convolutions, for messages.
enum class OtherOperator { none, bonds };

/// Makes the lattice of a body by convolutions.
/// @param of_springs setting of the springs that stand for the body in preconditioners
/// @param modulus    their micromodulus [N/m6]
/// @param cut        receives the bonds that pre-cracks have cut
/// @throws InputError as require_convolutions
[[nodiscard]] ConvolvedLattice make_convolved_lattice(const ModelSetting& setting,
                                                      const BondSetting& of_springs, double modulus,
                                                      CutBonds& cut, OtherOperator other);

/// Removes short bonds without a weight and those that pre-cracks cut.
void cut_short_bonds(Bonds& bonds, const ModelSetting& setting);

}  // namespace peristat
