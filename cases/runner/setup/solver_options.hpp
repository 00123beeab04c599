#pragma once

#include "cases/runner/input/case.hpp"
#include "solvers/study/study_options.hpp"

namespace peristat {

/// All options of the study of a case.
[[nodiscard]] StudyOptions study_options(const Case& from, int threads);

/// Options of the load stepping as a case gives them.
[[nodiscard]] LoadSteppingOptions load_stepping_options(const Case& from);

/// Options of Newton's method as a case gives them.
[[nodiscard]] NewtonOptions newton_options(const Case& from);

}  // namespace peristat
