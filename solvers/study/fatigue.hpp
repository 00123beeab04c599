#pragma once

#include "solvers/body/body.hpp"
#include "solvers/fracture/remaining_life.hpp"
#include "solvers/study/study_options.hpp"

namespace peristat {

/// Refuses bodies that mode fatigue does not follow: it needs brittle bonds of one material, whose
/// stretches in a cycle are proportional to its load.
/// @throws InputError
void check_fatigue(const Body& body, const StudyOptions& options);

/// What the body's pre-cracks have cut.
[[nodiscard]] inline InitialCuts initial_cuts(const Body& body) {
  return {body.cut_weight, body.cut_bonds};
}

}  // namespace peristat
