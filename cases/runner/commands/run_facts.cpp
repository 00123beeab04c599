#include "cases/runner/commands/run_facts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "cases/runner/input/case_inputs.hpp"
#include "cases/runner/process/output_file.hpp"
#include "cases/runner/results/folder/results_folder.hpp"
#include "cases/runner/results/tables/constraint_columns.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/point_file.hpp"

namespace peristat {

void leave_note(const std::filesystem::path& directory) {
  const char* file = std::getenv("PERISTAT_NOTE");
  if (!file || !*file) return;
  const std::string note = std::filesystem::absolute(directory).string() + "\n";
  std::FILE* const stream = open_own_file(file, "");
  std::fwrite(note.data(), 1, note.size(), stream);
  std::fclose(stream);
}

namespace {

std::filesystem::path resolved(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::path found = std::filesystem::weakly_canonical(path, error);
  return error ? std::filesystem::absolute(path).lexically_normal() : found;
}

}  // namespace

void keep_inputs_and_log_apart(const Case& from, const std::string& log_file) {
  const std::filesystem::path results = resolved(from.output.directory);
  for (const std::filesystem::path& file : inputs_of(from)) {
    if (is_name_of_results(resolved(file), results)) {
      throw InputError("directory", from.output.directory.string(),
                       file.string() +
                           " is read by the run, but a result of the run has the same name and "
                           "would replace it; name another results folder");
    }
    if (!log_file.empty() && resolved(file) == resolved(log_file)) {
      throw InputError("--log", log_file, "is an input of the run; name a new file");
    }
  }
  if (!log_file.empty() && is_below(resolved(log_file), results)) {
    throw InputError(
        "--log", log_file,
        "is in the results folder, whose files are replaced by each run; name a file outside of " +
            from.output.directory.string());
  }
}

std::filesystem::path identity(const std::filesystem::path& case_file) {
  std::error_code error;
  const std::filesystem::path file = std::filesystem::canonical(case_file, error);
  return error ? std::filesystem::absolute(case_file) : file;
}

std::vector<std::string> support_sets(const Case& from) {
  std::vector<std::string> sets;
  for (const SupportSpecification& support : from.supports) {
    const bool holds = std::any_of(support.displacement.begin(), support.displacement.end(),
                                   [](const auto& component) { return component.has_value(); });
    const bool known = std::find(sets.begin(), sets.end(), support.set) != sets.end();
    if (holds && !known) sets.push_back(support.set);
  }
  for (const auto& foundation : from.foundations) sets.push_back(foundation.name);
  for (const auto& obstacle : from.obstacles) sets.push_back(obstacle.name);
  const ConstraintSpecification& constraints = from.constraints;
  for (const auto& set : constraints.rigid_sets) sets.push_back(set.set);
  for (const auto& roller : constraints.rollers) sets.push_back(roller.name());
  for (const auto& linear : constraints.linear) sets.push_back(linear.name);
  for (std::size_t k = 0; k < constraints.symmetries.size(); ++k) {
    sets.push_back(name_of_plane(constraints.symmetries, k));
  }
  for (const auto& period : constraints.periods) {
    sets.push_back(name_of_period(period));
  }
  return sets;
}

double largest_displacement(const std::vector<double>& displacement, const Points& points) {
  double largest = 0.0;
  const std::size_t dimension = std::size_t(points.dimension);
  for (std::size_t k = 0; k < std::size_t(points.owned.value_or(points.own())) * dimension;
       k += dimension) {
    double squared = 0.0;
    for (std::size_t c = 0; c < dimension; ++c)
      squared += displacement[k + c] * displacement[k + c];
    largest = std::max(largest, squared);
  }
  return std::sqrt(largest);
}

std::vector<PointCounts> constant_fields_of(const Case& from, const Body& body) {
  std::vector<PointCounts> counts;
  if (const auto* const source = std::get_if<PointSource>(&from.body)) {
    const Index own = body.points.owned.value_or(body.points.own());
    counts.push_back({"source_row",
                      body.points.mesh
                          ? "number of each point's element or node in the file, from 0"
                      : source->file.empty() ? "number of each point as it was given, from 0"
                                             : "number of each point in the file's order, from 0",
                      !body.points.source_row.empty()
                          ? body.points.source_row
                          : source_rows(source->file, body.points, own, source->length_unit)});
  }
  const auto own = [&](auto values) {
    values.resize(std::size_t(body.points.owned.value_or(body.points.own())));
    return values;
  };
  for (const auto& term : body.model.terms()) {
    for (InteractionCount& kind : term->counts()) {
      for (std::int32_t& count : kind.per_point) count *= kind.orders;
      counts.push_back({kind.per_point_name, kind.per_point_meaning, own(kind.per_point)});
    }
  }
  if (!body.region.empty()) {
    counts.push_back(
        {"region", "number of the point's [[region]], from 0; -1: in no region", own(body.region)});
  }
  const auto add_factors = [&](const std::string& of, const std::vector<double>& factors) {
    if (factors.empty()) return;
    counts.push_back(
        {of + "_factor", "random factor of the " + of + " of the point's bonds", own(factors)});
  };
  add_factors("stiffness", body.factors.stiffness);
  add_factors("strength", body.factors.strength);
  return counts;
}

void add_costs(SolvedModel& solved, RunCosts& costs) {
  const LinearStatistics statistics = solved.solver().statistics();
  costs.factorisations += statistics.factorisations;
  costs.linear_iterations += statistics.iterations;
  costs.seconds.linear += statistics.seconds;
  costs.seconds.assembly += solved.assembler().seconds_spent();
}

std::string place_of_failure(const LoadSteppingResult& result, double load_factor, bool moves,
                             const std::optional<StepRecord>& last) {
  if (result.state.preload < 1.0) return "on the way to load 0";
  if (!moves) return fmt::format("after load factor {:.6g}", load_factor);
  return last && last->motion ? fmt::format("after time {:.6g} s", last->motion->time)
                              : "before the first time step";
}

std::string failure_reason(const LoadSteppingResult& result, const std::string& where,
                           const std::vector<DecisionRecord>& decisions) {
  if (result.outcome == Outcome::interrupted) return "interrupted " + where;
  const bool is_decided = !decisions.empty() && decisions.back().action == Decision::stop;
  std::string reason = is_decided ? decisions.back().reason : explanation(result.outcome);
  const auto& inertia = result.last_attempt.inertia;
  const bool has_counted = inertia && (inertia->negative > 0 || inertia->zero > 0);
  if (has_counted && reason.find("negative pivots)") == std::string::npos) {
    reason += fmt::format(" ({} negative and {} zero pivots)", inertia->negative, inertia->zero);
  }
  return fmt::format("{} {}: {}", name(result.outcome), where, reason);
}

std::string status_of(Outcome outcome) {
  if (outcome == Outcome::converged) return "completed";
  if (outcome == Outcome::interrupted) return "interrupted";
  return outcome == Outcome::inconsistent ? "inconsistent" : "not_converged";
}

namespace {

/// Reports unbalanced force: without a potential it is a visible error.
void report_unbalanced_force(const StepRecord& last, Progress& progress) {
  constexpr double worth_telling = 0.02;  // of the largest reaction
  double largest = 0.0;
  for (const auto& [set, force] : last.reactions) {
    largest = std::max(largest, std::hypot(force[0], force[1], force[2]));
  }
  if (last.unbalanced_force <= worth_telling * largest) return;
  progress.say(fmt::format(
      "loads and reactions differ by {:.3g} N: horizon and spacing are too coarse for this body",
      last.unbalanced_force));
}

}  // namespace

void report_result(const std::optional<StepRecord>& of_last, Progress& progress) {
  if (!of_last) return;
  const StepRecord& last = *of_last;
  for (const auto& [set, force] : last.reactions) {
    progress.say(fmt::format("reaction on {}: ({:.6g}, {:.6g}, {:.6g}) N", set, force[0], force[1],
                             force[2]));
  }
  report_unbalanced_force(last, progress);
  for (const auto& [probe, values] : last.probes) {
    progress.say(fmt::format("{}: {:.6g}", probe, fmt::join(values, ", ")));
  }
}

}  // namespace peristat
