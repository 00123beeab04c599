#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string>

#include "assembly/operators/unsymmetric_tangent.hpp"
#include "solvers/linear/linear_solver.hpp"

namespace peristat {

/// Factors L U of a sparse matrix that need not be symmetric, by UMFPACK with 64-bit indices and
/// threshold pivoting. A fill-reducing order is found once per pattern, and a matrix that comes
/// again, to the last bit, is not factorised again.
///
/// Works on one thread: its products are so small that two threads wait for each other more than
/// they win (on busy cores up to thirty times as long), and so its bits do not depend on their
/// number.
class LuFactor {
 public:
  /// @param most_bytes matrix and factor may take; factorize ends as out_of_memory where they are
  ///        expected to need more, before they take it
  explicit LuFactor(double most_bytes = std::numeric_limits<double>::infinity());
  ~LuFactor();

  /// Drops the numbers and the order.
  void reset();

  /// @return solved; singular where the condition number leaves no digit, and for values that are
  ///         not finite; out_of_memory. Pivots would not tell: without symmetry the last one of a
  ///         singular matrix may be 1e-6 of the largest.
  [[nodiscard]] LinearOutcome factorize(SparseRows matrix);
  /// Whether there are factors of the last matrix.
  [[nodiscard]] bool is_ready() const;

  /// v = A^-1 v, after a factorisation that went well. There is no refinement: residuals are for
  /// the operator itself to tell.
  void solve(std::span<double> v) const;

  /// Of the last matrix: sum_j |a_ij|.
  [[nodiscard]] double largest_row_sum() const;

  /// Counts over the life: orders that were found, and factorisations.
  [[nodiscard]] int orders() const;
  [[nodiscard]] int factorisations() const;

  /// Entries of L and U together, and flops of a factorisation; 0 before the first.
  [[nodiscard]] double entries() const;
  [[nodiscard]] double flops() const;
  /// "order AMD, 1.2e+06 entries (10 MB), 4e+08 flops"
  [[nodiscard]] std::string describe() const;

  /// Version of UMFPACK.
  [[nodiscard]] static std::string library_version();

 private:
  struct Umfpack;
  std::unique_ptr<Umfpack> umfpack_;
};

}  // namespace peristat
