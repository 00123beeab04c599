#pragma once

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// Makes a solid by convolutions. Its springs have the solid's Young's modulus and influence.
/// @param bonds those of setting_of_short_bonds
/// @param cut   receives the bonds that pre-cracks have cut
/// @throws InputError ("force_operator") for forces that are no convolution
[[nodiscard]] Model make_convolved_solid(const ModelSetting& setting, Bonds bonds, CutBonds& cut);

}  // namespace peristat
