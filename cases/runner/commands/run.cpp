#include "cases/runner/commands/run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include <H5public.h>
#include <fmt/format.h>

#include "cases/runner/build/body.hpp"
#include "cases/runner/build/solver_options.hpp"
#include "cases/runner/process/failure.hpp"
#include "cases/runner/process/interruption.hpp"
#include "cases/runner/results/dossier.hpp"
#include "cases/runner/results/probe.hpp"
#include "cases/runner/results/recorder.hpp"
#include "cases/runner/results/results.hpp"
#include "solvers/linear/cholesky.hpp"
#include "solvers/study/study.hpp"
#include "src/core/input_error.hpp"
#include "src/core/stopwatch.hpp"

namespace peristat {
namespace {

void leave_note(const std::filesystem::path& directory) {
  const char* file = std::getenv("PERISTAT_NOTE");
  if (!file || !*file) return;
  std::ofstream(file) << std::filesystem::absolute(directory).string() << '\n';
}

/// The file as every way to it names it, so that a later run knows it again.
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
  return sets;
}

double largest_displacement(const std::vector<double>& displacement, int dimension) {
  double largest = 0.0;
  for (std::size_t k = 0; k < displacement.size(); k += std::size_t(dimension)) {
    double squared = 0.0;
    for (int c = 0; c < dimension; ++c) squared += displacement[k + c] * displacement[k + c];
    largest = std::max(largest, squared);
  }
  return std::sqrt(largest);
}

/// The counts of [CPD] sec. 3.1 for the results folder.
std::vector<PointCounts> neighbour_counts_of(const Body& body) {
  std::vector<PointCounts> counts;
  for (const auto& term : body.model.terms()) {
    for (InteractionCount& kind : term->counts()) {
      for (std::int32_t& count : kind.per_point) count *= kind.orders;
      counts.push_back({kind.per_point_name, kind.per_point_meaning, std::move(kind.per_point)});
    }
  }
  return counts;
}

/// What is known of a run before its first step.
void count(const Body& body, const FreeDofs& free, const RunOptions& options, Summary& summary) {
  summary.points = body.points.count();
  summary.free_dofs = free.count();
  for (const auto& term : body.model.terms()) {
    for (const InteractionCount& kind : term->counts()) summary.count(kind.name, kind.count);
  }
  summary.seconds.neighbourhood = body.seconds_neighbourhood;
  summary.threads = options.threads;
}

/// Adds what assembly and linear solver have cost to the summary.
void add_costs(const Assembler& assembler, const LinearSolver& solver, Summary& summary) {
  const LinearStatistics statistics = solver.statistics();
  summary.factorisations += statistics.factorisations;
  summary.linear_iterations += statistics.iterations;
  summary.seconds.linear += statistics.seconds;
  summary.seconds.assembly += assembler.seconds_spent();
}

LoadSteppingResult follow_with_stand_in(const Case& from, Study& study, const Model& stand_in,
                                        const LoadSteppingObserver& observer, Summary& summary) {
  const Points& points = study.body().points;
  BodySize size = size_of(points);
  size.horizon_ratio = from.solver.elastic_horizon_ratio;
  size.bonds = double(stand_in.bonds().count());
  size.free_dofs = double(study.free().count());
  SolvedModel standing_in(
      points, stand_in, study.free(),
      choose_linear_systems(study.options(), stand_in, estimate_memory(size), {}),
      study.options().threads);
  if (standing_in.analyze() != LinearOutcome::solved) {
    LoadSteppingResult result;
    result.outcome = Outcome::out_of_memory;
    return result;
  }
  const SolvedBody solved = standing_in.solved();
  LoadSteppingResult result = study.follow(observer, &solved);
  add_costs(standing_in.assembler(), standing_in.solver(), summary);
  return result;
}

std::string failure_reason(const LoadSteppingResult& result) {
  if (result.outcome == Outcome::interrupted)
    return fmt::format("interrupted after load factor {:.6g}", result.state.load_factor);
  std::string reason = explanation(result.outcome);
  const auto& inertia = result.last_attempt.inertia;
  if (inertia && (inertia->negative > 0 || inertia->zero > 0)) {
    reason += fmt::format(" ({} negative and {} zero pivots)", inertia->negative, inertia->zero);
  }
  return fmt::format("{} after load factor {:.6g}: {}", name(result.outcome),
                     result.state.load_factor, reason);
}

std::string status_of(Outcome outcome) {
  if (outcome == Outcome::converged) return "completed";
  if (outcome == Outcome::interrupted) return "interrupted";
  return outcome == Outcome::inconsistent ? "inconsistent" : "not_converged";
}

void report_result(const Recorder& recorder, Progress& progress) {
  if (!recorder.last()) return;
  const StepRecord& last = *recorder.last();
  for (const auto& [set, force] : last.reactions) {
    progress.say(fmt::format("reaction on {}: ({:.6g}, {:.6g}, {:.6g}) N", set, force[0], force[1],
                             force[2]));
  }
  for (const auto& [probe, values] : last.probes) {
    progress.say(fmt::format("{}: {:.6g}", probe, fmt::join(values, ", ")));
  }
}

}  // namespace

std::map<std::string, std::string> versions() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return {{"peristat", PERISTAT_VERSION},
          {"hdf5", fmt::format("{}.{}.{}", major, minor, release)},
          {"cholmod", Cholesky::library_version()},
          {"compiler", fmt::format("GCC {}", __VERSION__)}};
}

namespace {

/// A run of a case, step by step.
class CaseRun {
 public:
  /// @param results is made as soon as the case is known to be right
  CaseRun(const Case& from, const RunOptions& options, Progress& progress, Summary& summary,
          std::optional<Results>& results)
      : from_(from), options_(options), progress_(progress), summary_(summary), results_(results) {}

  Exit run() {
    std::optional<Stopwatch> total(std::in_place, summary_.seconds.total);
    progress_.say(from_.title.empty() ? from_.file
                                      : fmt::format("{} ({})", from_.title, from_.file));
    make();
    heed_interruptions();
    open_results();
    const LoadSteppingResult result = follow();
    conclude(result);
    total.reset();
    results_->close(summary_);
    return tell(result);
  }

 private:
  /// Body, equations and their solver; refuses what can't be run.
  void make() {
    body_ = make_body(from_, options_.threads);
    study_.emplace(*body_, study_options(from_, options_.threads),
                   [this](const std::string& reason) { recorder_->changed_solver(reason); });
    const Index points = body_->points.count();
    const FreeDofs& free = study_->free();
    progress_.say(fmt::format("{} points, {} bonds, {} free degrees of freedom, {} threads", points,
                              body_->model.bonds().count(), free.count(), options_.threads));
    for (const std::string& line : describe_interactions(*body_)) progress_.say(line);
    count(*body_, free, options_, summary_);
  }

  void open_results() {
    std::vector<ProbeColumns> probes;
    for (const auto& probe : from_.probes) probes.push_back(columns_of(probe, from_.dimension));
    results_.emplace(
        from_.output.directory, body_->points,
        CaseText{from_.as_read, from_.as_resolved, from_.title, versions(), identity(from_.file)},
        support_sets(from_), probes, neighbour_counts_of(*body_), options_.overwrite);
    leave_note(from_.output.directory);
  }

  LoadSteppingResult follow() {
    SolvedModel& equations = study_->equations();
    recorder_.emplace(from_, *body_, equations.assembler(), *results_, progress_);
    study_->analyze();
    progress_.say(fmt::format("linear solver: {}{} ({})", equations.solver().describe(),
                              equations.systems().is_stored ? "" : ", tangent matrix-free",
                              equations.systems().chosen.reason));
    const std::optional<Model> stand_in = make_elastic_stand_in(from_, *body_, options_.threads);
    LoadSteppingResult result =
        stand_in ? follow_with_stand_in(from_, *study_, *stand_in, observer(), summary_)
                 : study_->follow(observer());
    add_costs(equations.assembler(), equations.solver(), summary_);
    return result;
  }

  LoadSteppingObserver observer() {
    LoadSteppingObserver told;
    told.iteration = [this](const IterationRecord& record) { recorder_->iteration(record); };
    told.decision = [this](const DecisionRecord& record) { recorder_->decided(record); };
    told.accepted = [this](const StepRecord& record, const AcceptedState& state) {
      recorder_->accepted(record, state);
      summary_.max_displacement = largest_displacement(state.trial.displacement, from_.dimension);
    };
    told.describe = [this](const InputError& error) {
      return std::string(located(from_, error).what());
    };
    told.interrupted = interruption_requested;
    return told;
  }

  /// What is known of a run after its last step.
  void conclude(const LoadSteppingResult& result) {
    summary_.status = status_of(result.outcome);
    if (result.outcome != Outcome::converged) summary_.reason = failure_reason(result);
    summary_.max_displacement = largest_displacement(result.state.displacement, from_.dimension);
    summary_.seconds.relaxation = result.relaxation_seconds;
    summary_.seconds.output = results_->seconds_spent();
    recorder_->finish();
    if (result.outcome == Outcome::converged || result.outcome == Outcome::interrupted) return;
    const Dossier dossier =
        make_dossier(from_, *body_, result, recorder_->last(), recorder_->decisions());
    results_->add_dossier(dossier.text, dossier.residual, dossier.displacement);
  }

  Exit tell(const LoadSteppingResult& result) {
    const std::string folder = from_.output.directory.string();
    if (result.outcome == Outcome::converged) {
      report_result(*recorder_, progress_);
      progress_.say(fmt::format("completed in {:.2f} s: {} steps, {} factorisations; results in {}",
                                summary_.seconds.total, result.steps, summary_.factorisations,
                                folder));
      return Exit::done;
    }
    progress_.problem(summary_.reason);
    progress_.problem(fmt::format("{} accepted steps are in {}", result.steps, folder));
    if (result.outcome == Outcome::interrupted) return Exit::interrupted;
    progress_.problem("dossier.txt there tells where it failed and what to do");
    return result.outcome == Outcome::out_of_memory ? Exit::out_of_memory : Exit::not_converged;
  }

  const Case& from_;
  const RunOptions& options_;
  Progress& progress_;
  Summary& summary_;
  std::optional<Results>& results_;
  std::unique_ptr<const Body> body_;
  std::optional<Study> study_;
  std::optional<Recorder> recorder_;
};

}  // namespace

Exit run(const Case& from, const RunOptions& options) {
  make_write_faults_errors();
  Progress progress(options.quiet, options.log_file);
  Summary summary;
  std::optional<Results> results;
  try {
    return located_errors(from,
                          [&] { return CaseRun(from, options, progress, summary, results).run(); });
  } catch (...) {
    if (!results) throw;
    const Failure failure = current_failure();
    results->fail(summary, failure.message);
    progress.problem(failure.message);
    progress.problem(results->what_is_left());
    if (failure.code == Exit::out_of_memory) {
      // What HDF5 could not allocate it can't close either: it would end in a segmentation fault.
      std::fflush(nullptr);
      std::_Exit(static_cast<int>(failure.code));
    }
    return failure.code;
  }
}

}  // namespace peristat
