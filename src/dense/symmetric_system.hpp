#pragma once

#include <memory>
#include <span>

namespace peristat {

/// Factors L D L^T of a symmetric matrix, with pivots along the diagonal.
class SymmetricFactors {
 public:
  SymmetricFactors();
  ~SymmetricFactors();
  SymmetricFactors(SymmetricFactors&&) noexcept;
  SymmetricFactors& operator=(SymmetricFactors&&) noexcept;

  /// @param matrix size x size entries, of which the lower half, column by column, is read
  void compute(std::span<const double> matrix, int size);

  /// True if the matrix could be factorised without a negative pivot, with all pivots above this
  /// fraction of the largest.
  [[nodiscard]] bool is_positive(double least_share) const;

  /// @param side becomes the solution
  void solve(std::span<double> side) const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

/// Solves A x = b with a symmetric A.
/// @param side becomes the solution
void solve_symmetric(std::span<const double> matrix, std::span<double> side);

}  // namespace peristat
