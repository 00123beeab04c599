#pragma once

#include <string>
#include <vector>

#include "cases/runner/setup/body.hpp"
#include "solvers/drivers/load_stepping.hpp"
#include "solvers/problem/records.hpp"

namespace peristat {

/// Report on why a run has stopped.
struct Dossier {
  std::string text;
  std::vector<double> residual;  ///< recorded points x dimension [N], 0 where nothing is solved for
  std::vector<double> displacement;  ///< of the state in which the last search ended [m]
};

/// Collective.
/// @param last the last accepted step, or nothing if there is none
/// @param decisions of the load stepping, all or the last ones
[[nodiscard]] Dossier make_dossier(const Case& from, const Body& body,
                                   const LoadSteppingResult& result,
                                   const std::optional<StepRecord>& last,
                                   const std::vector<DecisionRecord>& decisions);

}  // namespace peristat
