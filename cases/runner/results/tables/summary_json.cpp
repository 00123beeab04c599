#include "cases/runner/results/tables/summary_json.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "src/core/json_object.hpp"

namespace peristat {
std::int64_t Summary::counted(const std::string& kind) const {
  return std::ranges::find(interactions, kind, &std::pair<std::string, std::int64_t>::first)
      ->second;
}

void Summary::count(const std::string& kind, std::int64_t interactions_of_kind) {
  for (auto& [known, number] : interactions) {
    if (known != kind) continue;
    number = interactions_of_kind;
    return;
  }
  interactions.emplace_back(kind, interactions_of_kind);
}

void StepTotals::add(const StepRecord& record) {
  if (record.step > 0 || record.motion) ++steps;
  newton_iterations += record.newton_iterations;
  relaxation_iterations += record.relaxation_iterations;
  last = record;
}

std::string summary_json(const Summary& summary, const StepTotals& totals,
                         std::int64_t peak_memory_bytes) {
  const StepRecord last = totals.last.value_or(StepRecord{});

  JsonObject energy;
  energy.add("stored", last.stored_energy);
  energy.add("dissipated", last.dissipated_energy);
  energy.add("drained", last.drained_energy);
  energy.add("external_work", last.external_work);
  energy.add("numerical_work", last.numerical_work);
  energy.add("balance_error", last.balance_error);
  JsonObject reactions;
  for (const auto& [set, reaction] : last.reactions) reactions.add(set, std::span(reaction));
  JsonObject probes;
  for (const auto& [name, values] : last.probes) {
    if (values.size() == 1) {
      probes.add(name, values.front());
    } else {
      probes.add(name, std::span(values));
    }
  }
  JsonObject seconds;
  seconds.add("total", summary.costs.seconds.total);
  seconds.add("neighbourhood", summary.costs.seconds.neighbourhood);
  seconds.add("assembly", summary.costs.seconds.assembly);
  seconds.add("linear", summary.costs.seconds.linear);
  seconds.add("relaxation", summary.costs.seconds.relaxation);
  seconds.add("output", summary.costs.seconds.output);
  seconds.add("checkpoints", summary.costs.seconds.checkpoints);

  JsonObject all;
  all.add("status", summary.status);
  all.add("reason", summary.reason);
  all.add("points", summary.points);
  all.add("free_dofs", summary.free_dofs);
  for (const auto& [kind, count] : summary.interactions) all.add(kind, count);
  all.add("steps", totals.steps);
  all.add("newton_iterations", totals.newton_iterations);
  all.add("relaxation_iterations", totals.relaxation_iterations);
  all.add("factorisations", summary.costs.factorisations);
  all.add("linear_iterations", summary.costs.linear_iterations);
  all.add("broken_bonds", last.broken_bonds);
  all.add("max_damage", last.max_damage);
  all.add("max_displacement", summary.max_displacement);
  all.add("energy", energy);
  all.add("reactions", reactions);
  if (last.unbalanced_force > 0.0) all.add("unbalanced_force", last.unbalanced_force);
  all.add("probes", probes);
  all.add("seconds", seconds);
  all.add("peak_memory_bytes", peak_memory_bytes);
  all.add("threads", summary.threads);
  all.add("ranks", summary.ranks);
  all.add("warnings", summary.warnings);
  return all.text() + "\n";
}

}  // namespace peristat
