#pragma once

#include <algorithm>

#include "solvers/linear/make_linear_solver.hpp"

namespace peristat {

/// Counts that the memory of a run depends on.
struct BodySize {
  int dimension = 0;
  double points = 0.0;
  double longest = 1.0;  ///< points along the longest direction
  double places = 0.0;   ///< lattice sites in the box around the points
  double horizon_ratio = 0.0;
  double bonds = 0.0;
  double blocks = 0.0;               ///< off-diagonal blocks of a stored tangent; 0: bonds
  double coupling_ratio = 0.0;       ///< horizon of these blocks over the spacing; 0: that of bonds
  double bytes_per_bond = 6.0;       ///< neighbour and kind of bond, see BondKinds
  bool has_history = false;          ///< bonds may be damaged
  bool is_convolved = false;         ///< its bonds are convolutions: no rows are gathered
  bool has_runs = false;             ///< its sums go along runs, and rows are released
  bool has_symmetric_blocks = true;  ///< off-diagonal blocks of the tangent are symmetric
  bool is_constrained = false;       ///< degrees of freedom follow others
  double free_dofs = 0.0;
  double entries_per_row = 0.0;   ///< of an unsymmetric tangent; 0: the tangent is symmetric
  int ranks = 1;                  ///< that have a part each; the counts are those of one part
  double gathered_points = -1.0;  ///< points of the coarse level that is stored here; less than 0:
                                  ///< `points`

  [[nodiscard]] double stored_blocks() const { return blocks > 0.0 ? blocks : bonds; }
  [[nodiscard]] bool is_symmetric() const { return entries_per_row == 0.0; }
};

/// Memory of a run, estimated from counts alone.
struct MemoryEstimate {
  BodySize size;
  double factor_entries = 0.0;  ///< of the Cholesky factor, or of L and U
  double factor_flops = 0.0;    ///< of one factorisation
  double search_bytes = 0.0;    ///< of the search for neighbours, before the run
  double body_bytes = 0.0;      ///< of the run without its tangent and linear solver
  double tangent_bytes = 0.0;   ///< of a stored tangent
  double matrix_bytes = 0.0;    ///< of a direct solver without its factor

  [[nodiscard]] double direct_bytes(LinearMethod method = LinearMethod::cholesky) const;
  /// Memory of an iterative solver with its preconditioner; if none is named, rigid pieces, or the
  /// local operator for an unsymmetric tangent.
  [[nodiscard]] double iterative_bytes(const LinearSolverOptions& options) const;
  /// Memory of the whole run with a direct or an iterative solver, with or without a stored
  /// tangent.
  [[nodiscard]] double bytes(bool is_direct, bool is_stored,
                             const LinearSolverOptions& options) const {
    return bytes_with(is_stored,
                      is_direct ? direct_bytes(options.method) : iterative_bytes(options));
  }
  /// The same with a linear solver of so many bytes.
  [[nodiscard]] double bytes_with(bool is_stored, double of_solver) const {
    return std::max(search_bytes, body_bytes + (is_stored ? tangent_bytes : 0.0) + of_solver);
  }
  /// Memory of the whole run with the default iterative solver and without a stored tangent.
  [[nodiscard]] double least_bytes() const { return bytes(false, false, {}); }
};

/// Size and cost of the L U factors of an unsymmetric tangent, by nested dissection of a compact
/// body.
struct LuEstimate {
  double entries = 0.0;  ///< of L and U together
  double flops = 0.0;    ///< of one factorisation
};

/// Estimates the L U factors. Separators are as thick as rows are long: L and U have 0.6 e n log2 n
/// entries in 2D and 2.6 e^(2/3) n^(4/3) in 3D, the factorisation takes 0.35 e^2 n^(3/2) and 0.2
/// e^(4/3) n^2 flops. Fitted to UMFPACK's counts for 2 000 to 500 000 unknowns n with 17 to 440
/// entries e in a row; right within a factor of 2 in entries and 3 in flops.
[[nodiscard]] LuEstimate estimate_lu(int dimension, double unknowns, double entries_per_row);

/// Bonds of a point, each counted at one of its ends: half the volume of the horizon in cells.
[[nodiscard]] double bonds_per_point(int dimension, double horizon_ratio);

/// Estimates the memory of a run. The size of the factor is the smaller one of nested dissection
/// and of the natural order along the longest direction; their constants are fitted to the measured
/// table in docs/performance.md and hold within a factor of 1.5.
[[nodiscard]] MemoryEstimate estimate_memory(const BodySize& size);

}  // namespace peristat
