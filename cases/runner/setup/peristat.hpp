#pragma once

// All that a program needs to make a body, to follow it and to observe it: see docs/library.md.

#include "cases/runner/setup/body.hpp"
#include "cases/runner/setup/solver_options.hpp"
#include "solvers/observe/internal_force.hpp"
#include "solvers/observe/line_probe.hpp"
#include "solvers/observe/probe.hpp"
#include "solvers/observe/separated_bonds.hpp"
#include "solvers/study/study.hpp"
#include "src/core/input_error.hpp"
#include "src/core/machine_error.hpp"
#include "src/geometry/lattice.hpp"
#include "src/geometry/point_file.hpp"
