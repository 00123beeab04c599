#include "cases/runner/results/state_values.hpp"

#include "cases/runner/results/tables/constraint_columns.hpp"
#include "cases/runner/results/tables/crack_tip_columns.hpp"

namespace peristat {

LoadValues loads_of(const Conditions& conditions, const StepRecord& record) {
  const LoadingProgramme& programme = conditions.programme();
  LoadValues loads{programme.names(), programme.at(record.stage)};
  if (conditions.control()) loads.values.front() = record.load_factor;
  return loads;
}

std::string add_state_values(const ProbedBody& in, const Trial& state,
                             std::span<const double> external_force, const PointValues& fields,
                             const std::function<CrackState(const std::string&)>& crack_of,
                             StepRecord& record) {
  const LoadValues loads = loads_of(*in.body.conditions, record);
  for (const ProbeSpecification& probe : in.from.probes) {
    if (probe.from) continue;
    record.probes[probe.name] = probe_values(probe, in.points, fields, crack_of(probe.name), loads);
  }
  in.driven.add_values(state.displacement, external_force, loads, record.probes);
  std::string without_release = add_crack_tip_values(in.from, in.crack_tips, in.assembler, state,
                                                     record.stage, record.probes);
  add_constraint_values(*in.body.conditions, state, external_force, in.points.ranks(),
                        record.probes);
  return without_release;
}

}  // namespace peristat
