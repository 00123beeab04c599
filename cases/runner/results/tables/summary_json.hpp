#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cases/runner/results/tables/summary.hpp"
#include "solvers/problem/records.hpp"

namespace peristat {

/// Totals of the accepted steps for summary.json.
struct StepTotals {
  int steps = 0;
  std::int64_t newton_iterations = 0, relaxation_iterations = 0;
  std::optional<StepRecord> last;

  void add(const StepRecord& record);
};

/// Text of summary.json; energies, reactions and probes are those of the last step, all zero or
/// empty before the first.
/// @throws std::logic_error that names a number that is not finite
[[nodiscard]] std::string summary_json(const Summary& summary, const StepTotals& totals,
                                       std::int64_t peak_memory_bytes);

}  // namespace peristat
