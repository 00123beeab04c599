#pragma once

namespace peristat {

/// Speeds of an ordinary machine on one thread, as in benchmarks/RESULTS.md, for the choice of
/// linear solvers. They are constants, so that choices don't depend on the speed of the machine.
namespace speeds {
inline constexpr double factorisation = 3e10;              ///< [flop/s]
inline constexpr double unsymmetric_factorisation = 1e10;  ///< UMFPACK, on one thread [flop/s]
inline constexpr double solve = 1e10;        ///< reading a factor in triangular solves [bytes/s]
inline constexpr double fresh_memory = 1e9;  ///< dominates a small factorisation [bytes/s]
inline constexpr double product = 1.5e8;     ///< matrix-free [bonds/s]
inline constexpr double transform = 8e7;     ///< sine or cosine transform, one way [places/s]
}  // namespace speeds

/// Number of conjugate-gradient iterations, each reading the factor twice, that cost half a
/// factorisation; 0 if that takes less than a tenth of a second, as long as Trilinos takes to load.
[[nodiscard]] constexpr double affordable_iterations(double factor_flops, double factor_entries) {
  const double factorisation = factor_flops / speeds::factorisation;
  if (factorisation < 0.1) return 0.0;
  const double iteration = 2.0 * 8.0 * factor_entries / speeds::solve;
  return 0.5 * factorisation / iteration;
}

}  // namespace peristat
