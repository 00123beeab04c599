#pragma once

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// Summary of the quadrature of a body, for reports.
struct CollocationSummary {
  Index negative = 0, lowered = 0, solves = 0;
  double lowest = 0.0;  ///< weight over the volume of a cell
};

/// Makes the model; `cut` receives the bonds that pre-cracks have cut. Its bonds are those of a bond
/// model that dissipates as much. Collective for a part.
/// @throws InputError ("material.model") for thin bodies, and as optimised_weights does
[[nodiscard]] Model make_collocation_model(const ModelSetting& setting, Bonds bonds, CutBonds& cut,
                                           CollocationSummary& summary);

}  // namespace peristat
