#include "solvers/linear/memory_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "solvers/linear/speeds.hpp"

namespace peristat {
namespace {

/// Memory [bytes] of: program, libraries and files; CHOLMOD and BLAS, whose pages are read once a
/// linear system is solved; Trilinos, which is loaded on first use; further libraries of its
/// multigrid.
constexpr double base_bytes = 26e6, linear_algebra_bytes = 6e6, trilinos_bytes = 44e6,
                 multigrid_bytes = 11e6;

/// CHOLMOD's workspace beside the factor, as measured: 460 MB for the beam of
/// cases/cantilever, 1.56 GB for the plate with a hole at 120 000 points.
constexpr double factor_overhead = 1.2;

/// MUMPS, as measured: memory of its libraries; bytes per entry of its copies of the matrix and of
/// our pattern; and its factor with its workspace over Cholesky's, by dimension. Its order is worse
/// where the natural one is best, in slender bodies of 3D.
constexpr double ldlt_library_bytes = 8e6, ldlt_bytes_per_entry = 32.0;
constexpr std::array<double, 3> ldlt_overhead{1.2, 1.2, 2.0};

/// Memory of a run without its tangent and linear solver: the bonds, and vectors of the search for
/// equilibrium. Everything is stored once, in doubles unless noted.
double body_bytes(const BodySize& size) {
  const double d = size.dimension;
  // Reference position, last and present displacement, present and last gradient, loads, working
  // force, right-hand side, solution, and equations as pairs of integers.
  const double vectors = 11.5 * d;
  // Workspace: gathered rows and sums, see row_width and block_width. With convolutions there are
  // none, and a checkpoint determines the peak: four vectors as they are and as bytes.
  const double rows = size.has_runs ? 0.0 : size.dimension == 3 ? 8.0 : 4.0;
  const double sums = size.dimension == 3 ? 6.0 : 4.0;
  const double workspace = size.is_convolved ? 8.0 * d : rows + sums;
  const double scalars = 4.0;
  // Largest stretches, a copy of them for a step back, and flags.
  const double per_bond =
      size.bytes_per_bond + (size.has_history && !size.is_convolved ? 19.0 : 0.0);
  return base_bytes + per_bond * size.bonds + 8.0 * size.points * (vectors + workspace + scalars);
}

/// Memory of the neighbour search, which holds the bonds of its parts and the gathered ones.
double search_bytes(const BodySize& size) {
  return base_bytes + 2.0 * size.bytes_per_bond * size.bonds +
         8.0 * size.points * (2.0 * size.dimension + 5.0);
}

/// Krylov vectors, and one over all degrees of freedom.
double krylov_bytes(const BodySize& size, bool is_gmres) {
  const double d = size.dimension;
  // GMRES keeps a vector per iteration, some 25 of them where its preconditioner is good.
  const double vectors = is_gmres ? 31.0 : 6.0;
  return 8.0 * size.points * (vectors * d + d);
}

/// Coarse level of rigid pieces.
double coarse_bytes(const BodySize& size, double points) {
  const double d = size.dimension;
  const double motions = 0.5 * d * (d + 1.0);
  // Boxes are 5/3 horizons wide; in 3D they are larger where their factor would take more than 100
  // bytes per point, on more than sixteen ranks per point of sixteen ranks.
  const double most = 100.0 * std::min(1.0, 16.0 / double(size.ranks)) * points;
  double pieces = points / std::pow(5.0 / 3.0 * size.horizon_ratio, d);
  if (size.dimension == 3) pieces = std::min(pieces, std::pow(most / (8.0 * 36.0 * 8.0), 0.75));
  const double coarse = motions * pieces;
  const double factor = size.dimension == 3
                            ? std::min(8.0 * 36.0 * 8.0 * std::pow(pieces, 4.0 / 3.0), most)
                            : 8.0 * 3.2 * coarse * std::log2(std::max(coarse, 2.0));
  // Blocks of a piece with its neighbours, 26 in 3D, half of them stored: with their keys, and as
  // entries of which CHOLMOD makes two copies. At that time there are no Krylov vectors yet.
  const double gathered = 72.0 * motions * motions * pieces * 0.5 * (std::pow(3.0, d) + 1.0);
  return factor_overhead * factor + std::max(0.0, gathered - 8.0 * 6.0 * d * size.points);
}

/// Memory of rigid pieces beside krylov_bytes.
double rigid_pieces_bytes(const BodySize& size) {
  const double gathered = size.gathered_points < 0.0 ? size.points : size.gathered_points;
  return size.points * (4.0 * size.dimension + 16.0) +
         (gathered > 0.0 ? coarse_bytes(size, gathered) : 0.0);
}

/// Memory of the surrogate beside krylov_bytes: springs as a tangent and as a matrix, and their
/// factor.
double surrogate_bytes(const BodySize& size) {
  const double d = size.dimension, points = std::max(size.points, 2.0);
  const std::array<double, 3> springs{1.0, 4.0, 9.0};
  const double blocks = (springs[std::size_t(size.dimension) - 1] + 1.0) * points;
  double factor = 2.0 * blocks;  // of blocks
  if (size.dimension == 2) factor = 3.2 * points * std::log2(points);
  if (size.dimension == 3) {
    // Nested dissection of a slender body as a row of cubes.
    const double cubes = std::max(1.0, size.longest / std::sqrt(points / size.longest));
    factor = 8.0 * std::pow(points, 4.0 / 3.0) / std::sqrt(cubes);
  }
  return 8.0 * d * d * (3.0 * blocks + factor);
}

/// Bytes per entry of the assembled matrix of a Trilinos preconditioner, as measured: two copies of
/// the compressed rows, and the factors of RILUK or the coarser levels of multigrid.
double trilinos_bytes_per_entry(PreconditionerKind kind) {
  return kind == PreconditionerKind::chebyshev ? 24.0
         : kind == PreconditionerKind::riluk   ? 36.0
                                               : 33.0;
}

/// The same on several ranks: springs as a tangent, and as a matrix with the coarser levels of
/// multigrid.
double distributed_surrogate_bytes(const BodySize& size) {
  const double d = size.dimension;
  const std::array<double, 3> springs{1.0, 4.0, 9.0};
  const double blocks = springs[std::size_t(size.dimension) - 1];
  return d * d * size.points *
         (8.0 * blocks +
          trilinos_bytes_per_entry(PreconditionerKind::multigrid) * (2.0 * blocks + 1.0));
}

/// Bytes per entry of an unsymmetric tangent's rows for a factorisation: as rows() returns them,
/// and as UMFPACK stores them with its own workspace.
constexpr double lu_bytes_per_entry = 12.0 + 26.0;

/// UMFPACK's workspace over the factor.
constexpr double lu_overhead = 1.5;

/// Neighbours in the short-range approximation of an unsymmetric tangent, with the point itself.
constexpr std::array<double, 3> local_neighbours{3.0, 9.0, 27.0};

double lu_bytes(const BodySize& size, double entries_per_row) {
  const LuEstimate factor = estimate_lu(size.dimension, size.free_dofs, entries_per_row);
  return lu_bytes_per_entry * entries_per_row * size.points * size.dimension +
         8.0 * lu_overhead * factor.entries;
}

double local_operator_bytes(const BodySize& size) {
  return lu_bytes(size, local_neighbours[std::size_t(size.dimension) - 1] * size.dimension);
}

/// Number of vectors of GMRES for an unsymmetric tangent.
constexpr double vectors_of_unsymmetric_gmres = 70.0;

/// Memory of sines: the site of each point, and per lattice site of the box a value and the symbols
/// of the components in single precision.
double sines_bytes(const BodySize& size) {
  return 4.0 * size.points + (8.0 + 4.0 * size.dimension) * size.places;
}

/// Memory of an iterative solver for an unsymmetric tangent, with its preconditioner.
double unsymmetric_bytes(const BodySize& size, const LinearSolverOptions& options) {
  const double d = size.dimension;
  const bool keeps_vectors = options.method != LinearMethod::bicgstab;
  const double vectors = keeps_vectors ? vectors_of_unsymmetric_gmres : 12.0;
  const double bytes = linear_algebra_bytes + trilinos_bytes +
                       8.0 * size.points * (vectors * d + d + 0.5 * d * (d + 1.0));
  const bool is_local = options.preconditioner == PreconditionerKind::automatic ||
                        options.preconditioner == PreconditionerKind::local_operator;
  return bytes + (is_local ? local_operator_bytes(size) : 0.0);
}

}  // namespace

double bonds_per_point(int dimension, double horizon_ratio) {
  const double m = horizon_ratio;
  switch (dimension) {
    case 1:
      return m;
    case 2:
      return 0.5 * std::numbers::pi * m * m;
    default:
      return 2.0 / 3.0 * std::numbers::pi * m * m * m;
  }
}

LuEstimate estimate_lu(int dimension, double unknowns, double entries_per_row) {
  const double n = std::max(unknowns, 2.0), e = std::min(entries_per_row, n);
  LuEstimate estimate{n * e, 0.5 * n * e * e};  // banded matrix
  if (dimension == 2) {
    estimate = {0.6 * e * n * std::log2(n), 0.35 * e * e * std::pow(n, 1.5)};
  } else if (dimension == 3) {
    estimate = {2.6 * std::pow(e, 2.0 / 3.0) * std::pow(n, 4.0 / 3.0),
                0.2 * std::pow(e, 4.0 / 3.0) * n * n};
  }
  // At most a full matrix.
  return {std::min(estimate.entries, n * n), std::min(estimate.flops, 2.0 / 3.0 * n * n * n)};
}

MemoryEstimate estimate_memory(const BodySize& size) {
  const int dimension = size.dimension;
  const double horizon_ratio = size.coupling_ratio > 0.0 ? size.coupling_ratio : size.horizon_ratio;
  const double blocks = size.stored_blocks();
  MemoryEstimate estimate;
  estimate.size = size;
  const double d = dimension;
  const double n = std::max(size.free_dofs, 2.0);

  // A row of the natural order couples to the points of about 1.15 horizons along the body.
  const double section = size.points / std::max(size.longest, 1.0);
  const double band = std::min(n, d * section * (1.15 * horizon_ratio));
  const double natural_entries = n * band;
  const double natural_flops = 0.75 * n * band * band;
  // Separators of nested dissection are one horizon thick.
  const double thick = horizon_ratio / 3.015 * (horizon_ratio / 3.015);
  const double dissection_entries =
      dimension == 3 ? 98.0 * thick * std::pow(n, 4.0 / 3.0) : 29.0 * thick * n * std::log2(n);
  const double dissection_flops =
      dimension == 3 ? 297.0 * thick * thick * n * n : 1010.0 * thick * thick * std::pow(n, 1.5);
  estimate.factor_entries = std::min(natural_entries, dissection_entries);
  estimate.factor_flops = std::min(natural_flops, dissection_flops);

  if (!size.is_symmetric()) {
    const LuEstimate factor = estimate_lu(dimension, size.free_dofs, size.entries_per_row);
    estimate.factor_entries = factor.entries;
    estimate.factor_flops = factor.flops;
  }

  const double block = size.has_symmetric_blocks ? 0.5 * d * (d + 1.0) : d * d;
  estimate.search_bytes = search_bytes(size);
  estimate.body_bytes = body_bytes(size) + 8.0 * size.points * d * (d + 1.0);
  estimate.tangent_bytes = 8.0 * blocks * block;
  // The reduced tangent in whole blocks, the places of its blocks, and its pattern.
  if (size.is_constrained) estimate.tangent_bytes += blocks * (8.0 * d * d + 8.0 + 4.0);
  estimate.matrix_bytes = 16.0 * (blocks + size.points) * d * d;
  // The direct solver then also uses conjugate gradients with an old factor, which need Trilinos.
  if (affordable_iterations(estimate.factor_flops, estimate.factor_entries) > 1.0) {
    estimate.matrix_bytes += trilinos_bytes;
  }
  return estimate;
}

double MemoryEstimate::iterative_bytes(const LinearSolverOptions& options) const {
  if (!size.is_symmetric()) return unsymmetric_bytes(size, options);
  double bytes = linear_algebra_bytes + trilinos_bytes +
                 krylov_bytes(size, options.method == LinearMethod::gmres);
  const double d = size.dimension;
  const bool has_sines = options.preconditioner == PreconditionerKind::sines;
  if (!has_sines) bytes += 8.0 * size.points * 0.5 * d * (d + 1.0);  // block Jacobi
  switch (options.preconditioner) {
    case PreconditionerKind::jacobi:
    case PreconditionerKind::block_jacobi:
      return bytes;
    case PreconditionerKind::automatic:
    case PreconditionerKind::local_operator:  // not for symmetric tangents
    case PreconditionerKind::rigid_pieces:
      return bytes + rigid_pieces_bytes(size);
    case PreconditionerKind::surrogate:
      if (size.ranks > 1) return bytes + multigrid_bytes + distributed_surrogate_bytes(size);
      return bytes + surrogate_bytes(size);
    case PreconditionerKind::sines:
      return bytes + sines_bytes(size);
    case PreconditionerKind::multigrid:
      bytes += multigrid_bytes;
      [[fallthrough]];
    case PreconditionerKind::riluk:
    case PreconditionerKind::chebyshev:
      return bytes + trilinos_bytes_per_entry(options.preconditioner) * d * d *
                         (2.0 * size.stored_blocks() + size.points);
  }
  return bytes;
}

double MemoryEstimate::direct_bytes(LinearMethod method) const {
  if (!size.is_symmetric()) return linear_algebra_bytes + lu_bytes(size, size.entries_per_row);
  if (method == LinearMethod::ldlt) {
    const double d = size.dimension;
    return linear_algebra_bytes + ldlt_library_bytes +
           ldlt_bytes_per_entry * d * d * (size.stored_blocks() + size.points) +
           8.0 * ldlt_overhead[std::size_t(size.dimension) - 1] * factor_entries;
  }
  return linear_algebra_bytes + matrix_bytes + 8.0 * factor_overhead * factor_entries;
}

}  // namespace peristat
