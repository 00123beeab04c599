#include "cases/runner/results/tables/fatigue_columns.hpp"

namespace peristat {

std::vector<ProbeColumns> fatigue_columns(const Case& from) {
  if (from.solver.mode != Mode::fatigue) return {};
  return {{"cycles", 1, "1"}};
}

void add_fatigue_values(const StepRecord& record, const Case& from,
                        std::map<std::string, std::vector<double>>& values) {
  if (from.solver.mode == Mode::fatigue) values["cycles"] = {record.cycles};
}

}  // namespace peristat
