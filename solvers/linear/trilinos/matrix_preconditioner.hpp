#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "src/core/communicator.hpp"

// Stands between C++20 and Trilinos, which is compiled as C++17: this header is read by both.

namespace peristat {

/// A square matrix by rows: row i has the entries [begin[i], begin[i + 1]), columns ascending, the
/// diagonal always among them. Of a symmetric matrix both triangles.
///
/// Several ranks may have a part of the rows each, perhaps none: columns are then those of its own
/// rows and, from `rows` on, those of rows that others have.
struct CompressedRows {
  int rows = 0;
  std::vector<std::size_t> begin;  ///< rows + 1
  std::vector<int> column;
  std::vector<double> value;
  const Communicator* ranks = nullptr;  ///< null: all rows are here
  /// Rows of others that have columns here, by their numbers in the whole matrix: there the ranks'
  /// rows follow one another.
  std::vector<long long> ghosts{};
};

/// Displacements that (nearly) cost no energy, per equation: the rigid motions.
struct NearNullSpace {
  int count = 0;
  std::vector<double> values;  ///< one motion after the other, rows entries each
};

/// How equations belong to points.
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
  /// chebyshev, multigrid: to estimate the largest eigenvalue of D^-1 A. Taken too small, the
  /// polynomial is negative beyond, and the preconditioner indefinite.
  int lanczos_steps = 30;
  int largest_coarse_system = 1000;  ///< multigrid: equations that are solved directly
};

/// Approximate inverse M of an assembled symmetric positive definite matrix A; M is symmetric
/// positive definite, too, up to round-off, and fit for conjugate gradients.
///
/// Works on one thread. Prints nothing. Of several ranks all make the same calls, of matrices with
/// their parts of the rows.
class MatrixPreconditioner {
 public:
  /// Throws std::runtime_error where Trilinos can't be loaded.
  explicit MatrixPreconditioner(MatrixPreconditionerKind kind,
                                const MatrixPreconditionerOptions& options = {});
  ~MatrixPreconditioner();

  /// Takes a matrix, of which it keeps what it needs. Riluk and chebyshev need the matrix alone.
  /// @return false where there is no such preconditioner, on all ranks; failure() says why. What
  /// one
  ///         rank meets alone leaves as an exception: the others wait.
  [[nodiscard]] bool build(const CompressedRows& matrix, const EquationBlocks& blocks = {},
                           const NearNullSpace& near_null_space = {});
  [[nodiscard]] const std::string& failure() const;

  /// z = M r; both have one entry per equation and do not overlap. After a build that went well.
  void apply(const double* r, double* z);

  /// A line for the log: what it is and how large.
  [[nodiscard]] std::string describe() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Version of Trilinos, which this loads.
[[nodiscard]] std::string trilinos_version();

}  // namespace peristat
