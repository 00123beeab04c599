#pragma once

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// Bond setting of a body of model "lps" with the form "energy": the influence is K(r) r / delta,
/// so that a bond stores as much in a dilation as one of the bond model.
/// @param setting with the influence K
[[nodiscard]] BondSetting state_setting(BondSetting setting);

/// Makes the model. Collective for a part.
/// @param bonds with state_setting; of a part those of_neighbours
[[nodiscard]] MadeModel make_state_model(const ModelSetting& setting, Bonds bonds);

}  // namespace peristat
