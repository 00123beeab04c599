#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string>

#include "assembly/operators/unsymmetric_tangent.hpp"
#include "solvers/linear/linear_solver.hpp"

namespace peristat {

/// L U factors of a sparse matrix that need not be symmetric, by UMFPACK with 64-bit indices and
/// threshold pivoting. A fill-reducing order is found once per pattern. A matrix that equals the
/// last one to the last bit is not factorised again.
///
/// Works on one thread: its products are so small that two threads lose more by waiting for each
/// other than they gain (on busy cores up to thirty times as long). The result therefore does not
/// depend on the number of threads.
class LuFactor {
 public:
  /// @param most_bytes limit for matrix and factor; factorize returns out_of_memory if they are
  ///        expected to need more, before they are allocated
  explicit LuFactor(double most_bytes = std::numeric_limits<double>::infinity());
  ~LuFactor();

  /// Frees the factors and the order.
  void reset();

  /// @return solved; singular if the condition number leaves no digit, and for values that are not
  ///         finite; out_of_memory. Pivots are no criterion: without symmetry the last pivot of a
  ///         singular matrix may be 1e-6 of the largest.
  [[nodiscard]] LinearOutcome factorize(SparseRows matrix);
  /// True if there are factors of the last matrix.
  [[nodiscard]] bool is_ready() const;

  /// v = A^-1 v, after a successful factorisation. There is no refinement: the caller computes
  /// residuals with the operator itself.
  void solve(std::span<double> v) const;

  /// Largest sum_j |a_ij| of the last matrix.
  [[nodiscard]] double largest_row_sum() const;

  /// Numbers of orders and factorisations computed so far.
  [[nodiscard]] int orders() const;
  [[nodiscard]] int factorisations() const;

  /// Entries of L and U together, and flops of a factorisation; 0 before the first.
  [[nodiscard]] double entries() const;
  [[nodiscard]] double flops() const;
  /// "AMD order, factor 1.2e+06 entries (10 MB), 4e+08 flops"
  [[nodiscard]] std::string describe() const;

  /// Version of UMFPACK.
  [[nodiscard]] static std::string library_version();

 private:
  struct Umfpack;
  std::unique_ptr<Umfpack> umfpack_;
};

}  // namespace peristat
