#include "cases/runner/results/tables/motion_columns.hpp"

namespace peristat {

std::vector<ProbeColumns> motion_columns(const Case& from) {
  if (!from.dynamics.is_asked_for) return {};
  std::vector<ProbeColumns> columns{{"time", 1, "s"},
                                    {"time_step", 1, "s"},
                                    {"kinetic_energy", 1, "J"},
                                    {"modified_energy", 1, "J"}};
  for (int c = 0; c < from.dimension; ++c) {
    columns.push_back({std::string("momentum_") + "xyz"[c], 1, "kg m/s"});
  }
  return columns;
}

void add_motion_values(const StepRecord& record, int dimension,
                       std::map<std::string, std::vector<double>>& values) {
  if (!record.motion) return;
  const MotionRecord& motion = *record.motion;
  values["time"] = {motion.time};
  values["time_step"] = {motion.time_step};
  values["kinetic_energy"] = {motion.kinetic_energy};
  values["modified_energy"] = {motion.modified_energy};
  for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
    values[std::string("momentum_") + "xyz"[c]] = {motion.momentum[c]};
  }
}

}  // namespace peristat
