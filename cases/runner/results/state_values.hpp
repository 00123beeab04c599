#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/results/tables/driven_sets.hpp"
#include "solvers/body/body.hpp"
#include "solvers/observe/probe.hpp"
#include "solvers/problem/equilibrium.hpp"
#include "solvers/problem/records.hpp"
#include "solvers/study/crack_tips.hpp"

namespace peristat {

/// A body in which a case's probes, driven sets, crack tips and constraints are evaluated; what it
/// refers to must outlive it.
struct ProbedBody {
  const Case& from;
  const Body& body;
  Assembler& assembler;
  const RecordedPoints& points;
  const DrivenSets& driven;
  const std::vector<CrackTip>& crack_tips;
};

/// Returns the load parameters of a step.
[[nodiscard]] LoadValues loads_of(const Conditions& conditions, const StepRecord& record);

/// Adds the values of all probes but lines, of driven sets, crack tips and constraints in a state
/// to its record. Collective.
/// @param fields of the recorded points, with those that the probes need and the displacement
/// @param crack_of the state of the cracks for a probe, by its name
/// @return names of the crack tips whose cut body has no equilibrium; their rates are 0
[[nodiscard]] std::string add_state_values(
    const ProbedBody& in, const Trial& state, std::span<const double> external_force,
    const PointValues& fields, const std::function<CrackState(const std::string&)>& crack_of,
    StepRecord& record);

}  // namespace peristat
