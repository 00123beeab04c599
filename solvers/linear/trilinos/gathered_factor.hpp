#pragma once

#include <cstddef>
#include <vector>

#include "src/core/communicator.hpp"

// Read as C++17, too.

namespace peristat::trilinos {

/// Rows of a small symmetric matrix that a rank has.
struct GatheredRows {
  std::vector<long long> number;   ///< of each row in the whole matrix
  std::vector<std::size_t> begin;  ///< of each row in its entries, and the end
  std::vector<long long> column;   ///< numbers of rows, too
  std::vector<double> value;
};

/// Cholesky's factor of a small matrix whose rows several ranks have: dense, at rank 0. All ranks
/// make the same calls.
class GatheredFactor {
 public:
  /// More rows than that have none: 200 MB.
  static constexpr int most_rows = 5000;

  /// @param ranks outlive it
  explicit GatheredFactor(const Communicator& ranks) : ranks_(ranks) {}

  /// @return false on all ranks where there is none: too many rows, or a matrix that is not
  ///         positive definite
  [[nodiscard]] bool factorize(const GatheredRows& rows);

  /// @param b, x of the rows here
  void solve(const double* b, double* x) const;

 private:
  const Communicator& ranks_;
  std::size_t first_ = 0, own_ = 0;  // rows of the ranks before, and of this one
  int all_ = 0;
  std::vector<double> factor_;  // at rank 0: columns of the lower triangle, in a square
};

}  // namespace peristat::trilinos
