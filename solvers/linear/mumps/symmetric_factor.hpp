#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace peristat::mumps {

/// Entries of the lower triangle of a symmetric matrix, numbered from 1. Each place occurs once.
struct LowerEntries {
  int rows = 0;
  std::vector<int> row, column;
};

enum class FactorOutcome {
  done,
  singular,
  put_off,  ///< pivoting delayed more rows than there was room for: far from definite
  out_of_memory
};

/// L D L^T of a symmetric matrix that need not be definite, with pivots of one and two rows: MUMPS
/// (Amestoy, Duff, L'Excellent and Koster, SIAM J. Matrix Anal. Appl. 23, 2001), on one process.
///
/// Its members throw std::runtime_error for errors that MUMPS reports of the call itself.
class SymmetricFactor {
 public:
  virtual ~SymmetricFactor() = default;

  /// Analyses a pattern, once; the entries outlive the factor.
  [[nodiscard]] virtual FactorOutcome analyze(const LowerEntries& entries) = 0;
  /// Estimates of the analysis: entries and flops of a factorisation without further pivoting.
  [[nodiscard]] virtual double expected_entries() const = 0;
  [[nodiscard]] virtual double expected_flops() const = 0;

  /// @param values in the order of the entries
  [[nodiscard]] virtual FactorOutcome factorize(std::vector<double>& values) = 0;
  [[nodiscard]] virtual std::int64_t negative_pivots() const = 0;

  /// Overwrites the right-hand side with the solution.
  virtual void solve(double* right_hand_side) = 0;
};

/// Version of MUMPS.
[[nodiscard]] std::string version();

}  // namespace peristat::mumps
