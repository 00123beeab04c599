#pragma once

#include <cstdio>
#include <string>

#include "cases/runner/commands/run.hpp"
#include "cases/runner/input/case.hpp"

namespace peristat {

/// Compares residual and tangent of a case with central finite differences of energy and residual,
/// at one deformation and along one direction, and prints JSON.
///
/// `residual_error` is the smallest over step sizes h of |(E(u+hv) - E(u-hv))/2h - dE.v| / |dE.v|,
/// and `tangent_error` that of ||(g(u+hv) - g(u-hv))/2h - K v|| / ||K v||. The orders are log2 of
/// the ratio of the errors of successive halvings of h, at the smallest h at which truncation still
/// dominates round-off; central differences have order 2 exactly when the derivative is right.
/// Where truncation never does (the energy of a harmonic bar in 1D is quadratic) the order is null.
///
/// Supports and dead loads are ignored. Constraints, eigenstrains, pressures, foundations and
/// obstacles act as at the end of the load.
///
/// @param deformation current coordinates as expressions of x, y, z, separated by ';'; empty for a
///        fixed asymmetric deformation
/// @throws InputError for a bad expression, or a deformation that collapses a bond
[[nodiscard]] Exit check_tangent(const Case& from, const std::string& deformation, int threads,
                                 std::FILE* out = stdout);

}  // namespace peristat
