#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "src/parallel/communicator.hpp"

// Interface between C++20 and Trilinos, which is compiled as C++17: both include this header.

namespace peristat {

/// A square matrix by rows: row i has the entries [begin[i], begin[i + 1]), columns ascending, the
/// diagonal always among them. A symmetric matrix has both triangles.
///
/// On several ranks each has a part of the rows, perhaps none. Its columns are then those of its
/// own rows and, from `rows` on, those of rows of other ranks.
struct CompressedRows {
  int rows = 0;
  std::vector<std::size_t> begin;  ///< rows + 1
  std::vector<int> column;
  std::vector<double> value;
  const Communicator* ranks = nullptr;  ///< null: all rows are here
  /// Rows of other ranks that have columns here, by their numbers in the whole matrix, where the
  /// ranks' rows follow one another.
  std::vector<long long> ghosts{};
};

/// Displacements that (nearly) cost no energy, per equation: the rigid motions.
struct NearNullSpace {
  int count = 0;
  std::vector<double> values;  ///< one motion after the other, rows entries each
};

/// Assignment of equations to points.
struct EquationBlocks {
  int size = 1;  ///< degrees of freedom per point
  /// Degree of freedom of each equation, ascending; that of point p are size p, size p + 1, …
  /// Empty: no degree of freedom is prescribed, equation e is degree of freedom e.
  std::vector<int> dof;
};

enum class MatrixPreconditionerKind {
  riluk,      ///< incomplete factors with the entries of A, Ifpack2
  chebyshev,  ///< polynomial in A scaled by its diagonal, Ifpack2
  multigrid,  ///< smoothed aggregation, MueLu
};

struct MatrixPreconditionerOptions {
  int level_of_fill = 0;     ///< riluk: 0 keeps the pattern of A
  int chebyshev_degree = 4;  ///< products with A per application are one less
  /// chebyshev, multigrid: steps to estimate the largest eigenvalue of D^-1 A. If it is too small,
  /// the polynomial is negative beyond it, and the preconditioner indefinite.
  int lanczos_steps = 30;
  int largest_coarse_system = 1000;  ///< multigrid: equations that are solved directly
};

/// Approximate inverse M of an assembled symmetric positive definite matrix A. M is symmetric
/// positive definite, too, up to round-off, and suitable for conjugate gradients.
///
/// Works on one thread. Prints nothing. On several ranks all calls are collective, with each rank's
/// part of the rows.
class MatrixPreconditioner {
 public:
  /// @throws std::runtime_error if Trilinos can't be loaded
  explicit MatrixPreconditioner(MatrixPreconditionerKind kind,
                                const MatrixPreconditionerOptions& options = {});
  ~MatrixPreconditioner();

  /// Builds the preconditioner of a matrix, which need not live on. Riluk and chebyshev need the
  /// matrix alone.
  /// @return false on all ranks if there is no such preconditioner; failure() says why. An error
  ///         that one rank meets alone is thrown, because the others wait.
  [[nodiscard]] bool build(const CompressedRows& matrix, const EquationBlocks& blocks = {},
                           const NearNullSpace& near_null_space = {});
  [[nodiscard]] const std::string& failure() const;

  /// z = M r; both have one entry per equation and do not overlap. After a successful build.
  void apply(const double* r, double* z);

  /// A line for the log: what it is and how large.
  [[nodiscard]] std::string describe() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Version of Trilinos; loads its module.
[[nodiscard]] std::string trilinos_version();

}  // namespace peristat
