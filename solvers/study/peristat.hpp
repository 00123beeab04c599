#pragma once

// All that a program needs to make a body and to follow it: see docs/library.md.

#include "solvers/study/study.hpp"
#include "src/core/input_error.hpp"
#include "src/core/machine_error.hpp"
#include "src/geometry/lattice.hpp"
#include "src/geometry/point_file.hpp"
