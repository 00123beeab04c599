#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solvers/problem/records.hpp"

namespace peristat {

/// A residual over that right after the step's jump, and the relative residual that the linear
/// system of its iteration was solved to (0: directly).
struct ResidualRatio {
  double value = 0.0, linear_tolerance = 0.0;
};

/// Residuals of the iterations of every accepted step over that right after the step's jump, in the
/// layout of Table 3 of [CPD]: a row per iteration, a column per step, and a last row with the
/// observed order of convergence.
class ConvergenceTable {
 public:
  /// The iterations of a step come in order, those of attempts that were given up included.
  void add(const IterationRecord& record);

  /// The present attempt ended in an accepted step.
  void accept(int step);

  /// As comma-separated values; cells of iterations that a step did not need are empty.
  [[nodiscard]] std::string csv() const;

 private:
  struct Column {
    int step;
    std::vector<ResidualRatio> ratios;
  };

  int last_iteration_ = -1;
  std::vector<ResidualRatio> attempt_;
  std::vector<Column> columns_;
};

/// Order p = log(r_(k+1)/r_k) / log(r_k/r_(k-1)) of the last three consecutive residuals that can
/// show it: neither far from the solution (r_(k-1) < 0.2 of the first) nor round-off (r_(k+1) >
/// 1e-13 of it), and more than a hundred times what the linear solver has left of the previous
/// residual. None if there are no such three.
[[nodiscard]] std::optional<double> observed_order(const std::vector<ResidualRatio>& ratios);

}  // namespace peristat
