#pragma once

namespace peristat {

/// Speeds of a plain machine on one thread, as in benchmarks/RESULTS.md, that choices of linear
/// solvers go by: they are constants, so that choices don't depend on how fast a machine happens to
/// be.
namespace speeds {
inline constexpr double factorisation = 3e10;              ///< [flop/s]
inline constexpr double unsymmetric_factorisation = 1e10;  ///< UMFPACK, on one thread [flop/s]
inline constexpr double solve = 1e10;        ///< reading a factor in triangular solves [bytes/s]
inline constexpr double fresh_memory = 1e9;  ///< which a small factorisation mostly takes [bytes/s]
inline constexpr double product = 1.5e8;     ///< matrix-free [bonds/s]
inline constexpr double transform = 8e7;     ///< by sines and cosines, there or back [places/s]
}  // namespace speeds

/// Iterations of conjugate gradients, each reading the factor twice, that half a factorisation
/// buys; none where it takes less than a tenth of a second, as long as Trilinos takes to load.
[[nodiscard]] constexpr double affordable_iterations(double factor_flops, double factor_entries) {
  const double factorisation = factor_flops / speeds::factorisation;
  if (factorisation < 0.1) return 0.0;
  const double iteration = 2.0 * 8.0 * factor_entries / speeds::solve;
  return 0.5 * factorisation / iteration;
}

}  // namespace peristat
