#pragma once

#include <map>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/results/tables/probe_columns.hpp"
#include "solvers/study/crack_tips.hpp"

namespace peristat {

/// Columns NAME_J [J/m2], NAME_J_spread [1], and for isotropic materials NAME_K1, NAME_K2, in 3D
/// NAME_K3 [Pa m^0.5], and NAME_T [Pa] of every crack tip; with a cut also NAME_G_displacement and
/// NAME_G_load [J/m2].
[[nodiscard]] std::vector<ProbeColumns> crack_tip_columns(const Case& from);

/// Adds the values of these columns in a state.
/// @return names of the tips whose cut body has no equilibrium, for messages; their rates are 0
[[nodiscard]] std::string add_crack_tip_values(const Case& from, const std::vector<CrackTip>& tips,
                                               Assembler& assembler, const Trial& state,
                                               double stage,
                                               std::map<std::string, std::vector<double>>& values);

}  // namespace peristat
