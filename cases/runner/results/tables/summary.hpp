#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "cases/runner/results/tables/run_costs.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// Everything of summary.json that the step records do not hold.
struct Summary {
  std::string status;  ///< "completed", "not_converged", "inconsistent", "interrupted", "failed"
  std::string reason;  ///< sentence for a person when the status is not "completed"
  Index points = 0;
  std::int64_t free_dofs = 0;
  /// Number of interactions of each kind; readers find these three in every run.
  std::vector<std::pair<std::string, std::int64_t>> interactions{
      {"bonds", 0}, {"triangles", 0}, {"tetrahedra", 0}};
  RunCosts costs;
  double max_displacement = 0.0;
  int threads = 1, ranks = 1;
  std::vector<std::string> warnings;  ///< about what may not be intended

  /// Number of interactions of a kind that was counted.
  [[nodiscard]] std::int64_t counted(const std::string& kind) const;
  void count(const std::string& kind, std::int64_t interactions_of_kind);
};

}  // namespace peristat
