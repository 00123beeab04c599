#pragma once

#include <cstddef>
#include <vector>

#include "src/parallel/communicator.hpp"

// Also compiled as C++17.

namespace peristat::trilinos {

/// Rows of a small symmetric matrix on one rank.
struct GatheredRows {
  std::vector<long long> number;   ///< of each row in the whole matrix
  std::vector<std::size_t> begin;  ///< of each row in its entries, and the end
  std::vector<long long> column;   ///< row numbers in the whole matrix
  std::vector<double> value;
};

/// Dense Cholesky factor of a small matrix whose rows are distributed over ranks; stored at rank 0.
/// All calls are collective.
class GatheredFactor {
 public:
  /// Largest matrix that is factorised: 200 MB.
  static constexpr int most_rows = 5000;

  /// @param ranks outlive it
  explicit GatheredFactor(const Communicator& ranks) : ranks_(ranks) {}

  /// @return false on all ranks if there are too many rows, or the matrix is not positive definite
  [[nodiscard]] bool factorize(const GatheredRows& rows);

  /// @param b, x entries of the rows of this rank
  void solve(const double* b, double* x) const;

 private:
  const Communicator& ranks_;
  std::size_t first_ = 0, own_ = 0;  // rows of earlier ranks, and of this one
  int all_ = 0;
  std::vector<double> factor_;  // at rank 0: columns of the lower triangle, in a square
};

}  // namespace peristat::trilinos
