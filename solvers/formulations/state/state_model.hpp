#pragma once

#include "assembly/terms/states/state_term.hpp"
#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// Bond setting of a body with an energy of states: the influence is K(r) r / delta,
/// so that a bond stores as much in a dilation as one of the bond model.
/// @param setting with the influence K
[[nodiscard]] BondSetting state_setting(BondSetting setting);

/// Micromodulus c with which a bond inside a lattice takes c w L times the work of its law in
/// damage by release: 2 d (d + 2) mu / m_1, m_1 the first moment of the bonds of state_setting.
/// @param setting with the influence K
[[nodiscard]] double micromodulus_of_states(const MaterialSpecification& material,
                                            const BondSetting& setting);

/// Refuses damage by release with lambda / mu so large that cracks run far above their energy.
/// @throws InputError ("….poisson_ratio")
void check_release_of_states(const MaterialSpecification& material, const std::string& key,
                             int dimension);
/// A warning of cracks that need more than their energy, if damage is by release; or nothing.
[[nodiscard]] std::string warning_of_late_cracks(const MaterialSpecification& material,
                                                 const std::string& key,
                                                 const BondSetting& setting);
/// By release G_c = c A times the work of the law: what a tear takes does not depend on lambda.
[[nodiscard]] FractureScale scale_of_states(const MaterialSpecification& material,
                                            const std::string& key, const BondSetting& setting,
                                            double spacing);

/// Makes the model. Collective for a part.
/// @param bonds with state_setting; of a part those of_neighbours
[[nodiscard]] MadeModel make_state_model(const ModelSetting& setting, Bonds bonds,
                                         StateRules rules);

}  // namespace peristat
