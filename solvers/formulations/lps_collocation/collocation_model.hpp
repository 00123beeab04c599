#pragma once

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// Makes the model. Its bonds are those of a bond model that dissipates as much. Collective for a
/// part.
/// @throws InputError ("material.model") for thin bodies, and as optimised_weights does
[[nodiscard]] MadeModel make_collocation_model(const ModelSetting& setting, Bonds bonds);

}  // namespace peristat
