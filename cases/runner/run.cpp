#include "cases/runner/run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include <H5public.h>
#include <fmt/format.h>

#include "assembly/damage.hpp"
#include "cases/runner/body.hpp"
#include "cases/runner/damage_histories.hpp"
#include "cases/runner/dossier.hpp"
#include "cases/runner/failure.hpp"
#include "cases/runner/interruption.hpp"
#include "cases/runner/probe.hpp"
#include "cases/runner/progress.hpp"
#include "cases/runner/rest_stability.hpp"
#include "cases/runner/solver_options.hpp"
#include "solvers/linear/cholesky.hpp"
#include "solvers/load_stepping.hpp"
#include "src/input_error.hpp"
#include "src/results/results.hpp"
#include "src/stopwatch.hpp"

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
  const auto ordered = [](std::vector<std::int32_t> counts, std::int32_t orders) {
    for (std::int32_t& count : counts) count *= orders;
    return counts;
  };
  std::vector<PointCounts> counts{
      {"neighbours", "neighbours within the horizon, #N1", neighbour_counts(body.model.bonds)}};
  if (body.model.triangles) {
    counts.push_back({"neighbour_pairs", "contributing ordered pairs of neighbours, #N2",
                      ordered(body.model.triangles->interactions.per_point(), 2)});
  }
  if (body.model.tetrahedra) {
    counts.push_back({"neighbour_triplets", "contributing ordered triplets of neighbours, #N3",
                      ordered(body.model.tetrahedra->interactions.per_point(), 6)});
  }
  return counts;
}

/// Turns accepted equilibria into rows, fields and probes of the results folder.
class Recorder {
 public:
  Recorder(const Case& from, const Body& body, Assembler& assembler, Results& results,
           Progress& progress)
      : case_(from),
        points_(body.points),
        assembler_(assembler),
        results_(results),
        progress_(progress),
        body_(body),
        separated_(body.cut_bonds) {}

  void iteration(const IterationRecord& record) {
    relative_residual_ = record.relative_residual;
    results_.add(record);
    progress_.iteration(record);
  }

  void accepted(StepRecord record, const AcceptedState& state) {
    const std::size_t points = points_.volume.size();
    const StateView at = state.trial.at();
    const std::span<const double> stretches = bond_stretches(body_.model, at.history);
    Fields made{state.trial.displacement,
                state.trial.gradient,
                std::vector<double>(points),
                std::vector<double>(points),
                std::vector<double>(points),
                std::vector<double>(points, 0.0),
                told_histories_.changes(body_.model.bonds, stretches)};
    for (double& force : made.force) force = -force;
    static_cast<void>(assembler_.point_energies(at, made.energy_density));
    assembler_.point_stretches(at, made.stretch);
    record.max_stretch = *std::max_element(made.stretch.begin(), made.stretch.end());
    const auto cut_weight =
        case_.output.count_cracks ? std::span(body_.cut_weight) : std::span<const double>();
    record.max_damage = assess_damage(body_.model, at.history, cut_weight, made.damage).max_damage;
    std::copy(state.piece.begin(), state.piece.end(), made.fragment.begin());
    tell_broken_bonds(record, at.history);
    for (std::size_t i = 0; i < points; ++i) made.energy_density[i] /= points_.volume[i];
    const StepFields fields = made.view();
    for (const ProbeSpecification& probe : case_.probes) {
      record.probes[probe.name] = probe_values(probe, points_, fields, separated_);
    }
    const bool write_fields = record.step % case_.output.every == 0;
    results_.add(record, write_fields ? std::optional(fields) : std::nullopt);
    if (write_fields) told_histories_.tell(stretches);
    progress_.accepted(record, relative_residual_);
    last_ = std::move(record);
    unwritten_.reset();
    if (!write_fields) unwritten_ = std::move(made);
  }

  /// Writes the fields of the last accepted state, whatever output.every says.
  void finish() {
    if (unwritten_) results_.add_fields(*last_, unwritten_->view());
  }

  [[nodiscard]] const std::optional<StepRecord>& last() const { return last_; }

 private:
  struct Fields {
    std::vector<double> displacement, force, damage, energy_density, stretch, fragment;
    std::optional<BondHistories> histories;
    [[nodiscard]] StepFields view() const {
      return {&displacement,
              &force,
              &damage,
              &energy_density,
              &stretch,
              &fragment,
              histories ? &*histories : nullptr};
    }
  };

  /// Adds the bonds that have broken since the last step to the results.
  void tell_broken_bonds(const StepRecord& record, const History& history) {
    std::vector<char> broken = broken_bonds(body_.model, history);
    if (broken.empty()) return;
    broken_.resize(broken.size(), 0);
    std::vector<BrokenBondRecord> records;
    const Bonds& bonds = body_.model.bonds;
    for (Index i = 0; i < bonds.points(); ++i) {
      for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
        if (!broken[bond] || broken_[bond]) continue;
        records.push_back({record.step, record.load_factor, i, bonds.partner[bond]});
        separated_.push_back({i, bonds.partner[bond]});
      }
    }
    broken_ = std::move(broken);
    results_.add(records);
  }

  const Case& case_;
  const Points& points_;
  Assembler& assembler_;
  Results& results_;
  Progress& progress_;
  const Body& body_;
  std::optional<Fields> unwritten_;  // of the last step, if it only entered the history
  std::vector<char> broken_;         // per bond, in the last accepted state
  DamageHistories told_histories_;   // in the last state that was written with fields
  std::vector<BondEnds> separated_;  // by pre-cracks, and broken until the last accepted state
  double relative_residual_ = 0.0;
  std::optional<StepRecord> last_;
};

/// What is known of a run before its first step.
void count(const Body& body, const FreeDofs& free, const RunOptions& options, Summary& summary) {
  summary.points = body.points.count();
  summary.free_dofs = free.count();
  summary.bonds = body.model.bonds.count();
  if (body.model.triangles) summary.triangles = body.model.triangles->interactions.count();
  if (body.model.tetrahedra) summary.tetrahedra = body.model.tetrahedra->interactions.count();
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

LoadSteppingResult follow_with_stand_in(const Case& from, const Body& body,
                                        const SolvedBody& solved, const Model& stand_in,
                                        const FreeDofs& free, const LoadSteppingObserver& observer,
                                        Summary& summary) {
  const Pattern pattern(stand_in.bonds);
  Assembler assembler(body.points, stand_in, solved.assembler.threads());
  BodySize size = size_of(body.points);
  size.horizon_ratio = from.solver.elastic_horizon_ratio;
  size.bonds = double(stand_in.bonds.count());
  size.free_dofs = double(free.count());
  const LinearSystems systems = choose_linear_systems(from, estimate_memory(size), {});
  LinearSolver& solver = *systems.chosen.solver;
  const std::unique_ptr<TangentOperator> tangent = systems.make_tangent(assembler);
  if (solver.analyze(pattern, free) != LinearOutcome::solved) {
    LoadSteppingResult result;
    result.outcome = Outcome::out_of_memory;
    return result;
  }
  const SolvedBody standing_in{assembler, solver, *tangent, free};
  LoadSteppingResult result = follow_loading(solved, *body.conditions, load_stepping_options(from),
                                             newton_options(from), observer, &standing_in);
  add_costs(assembler, solver, summary);
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

void tell_result(const Recorder& recorder, Progress& progress) {
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

/// @param results is made as soon as the case is known to be right
Exit run_case(const Case& from, const RunOptions& options, Progress& progress, Summary& summary,
              std::optional<Results>& results) {
  std::optional<Stopwatch> total(std::in_place, summary.seconds.total);
  progress.say(from.title.empty() ? from.file : fmt::format("{} ({})", from.title, from.file));

  const std::unique_ptr<const Body> made = make_body(from, options.threads);
  const Body& body = *made;
  refuse_unheld_bodies(from, body);
  refuse_unstable_rest(from, body, options.threads);
  std::vector<DecisionRecord> decisions;
  const auto decide = [&](const DecisionRecord& record) {
    decisions.push_back(record);
    results->add(record);
    progress.decision(record);
  };
  StepRecord last_step;
  const MemoryEstimate estimate = estimate_memory(body);
  const LinearSystems systems =
      choose_linear_systems(from, estimate, [&](const std::string& reason) {
        DecisionRecord record;
        record.step = last_step.step + 1;
        record.load_factor = last_step.load_factor;
        record.action = "change linear solver";
        record.reason = reason;
        decide(record);
      });
  require_memory(systems.bytes, fmt::format("the case with {} points", body.points.count()));
  const FreeDofs free(body.conditions->prescribed(), from.dimension);
  progress.say(fmt::format("{} points, {} bonds, {} free degrees of freedom, {} threads",
                           body.points.count(), body.model.bonds.count(), free.count(),
                           options.threads));
  for (const std::string& line : describe_interactions(body)) progress.say(line);
  count(body, free, options, summary);

  heed_interruptions();
  std::vector<ProbeColumns> probes;
  for (const auto& probe : from.probes) probes.push_back(columns_of(probe, from.dimension));
  results.emplace(
      from.output.directory, body.points,
      CaseText{from.as_read, from.as_resolved, from.title, versions(), identity(from.file)},
      support_sets(from), probes, neighbour_counts_of(body), options.overwrite);
  leave_note(from.output.directory);

  const Pattern pattern(body.model.bonds);
  Assembler assembler(body.points, body.model, options.threads);
  const std::unique_ptr<TangentOperator> tangent = systems.make_tangent(assembler);
  LinearSolver& solver = *systems.chosen.solver;
  const LinearOutcome analysis = solver.analyze(pattern, free);
  progress.say(fmt::format("linear solver: {}{} ({})", solver.describe(),
                           systems.is_stored ? "" : ", tangent matrix-free",
                           systems.chosen.reason));

  Recorder recorder(from, body, assembler, *results, progress);
  LoadSteppingObserver observer;
  observer.iteration = [&](const IterationRecord& record) { recorder.iteration(record); };
  observer.decision = decide;
  observer.accepted = [&](const StepRecord& record, const AcceptedState& state) {
    recorder.accepted(record, state);
    last_step = record;
    summary.max_displacement = largest_displacement(state.trial.displacement, from.dimension);
  };
  observer.describe = [&](const InputError& error) {
    return std::string(located(from, error).what());
  };
  observer.interrupted = interruption_requested;

  LoadSteppingResult result;
  if (analysis == LinearOutcome::solved) {
    const SolvedBody solved{assembler, solver, *tangent, free};
    if (const std::optional<Model> stand_in = make_elastic_stand_in(from, body, options.threads)) {
      result = follow_with_stand_in(from, body, solved, *stand_in, free, observer, summary);
    } else {
      result = follow_loading(solved, *body.conditions, load_stepping_options(from),
                              newton_options(from), observer);
    }
  } else {
    result.outcome = Outcome::out_of_memory;
  }

  const bool interrupted = result.outcome == Outcome::interrupted;
  const bool completed = result.outcome == Outcome::converged;
  summary.status = status_of(result.outcome);
  if (!completed) summary.reason = failure_reason(result);
  add_costs(assembler, solver, summary);
  summary.max_displacement = largest_displacement(result.state.displacement, from.dimension);
  summary.seconds.relaxation = result.relaxation_seconds;
  summary.seconds.output = results->seconds_spent();
  recorder.finish();
  if (!completed && !interrupted) {
    const Dossier dossier = make_dossier(from, body, result, recorder.last(), decisions);
    results->add_dossier(dossier.text, dossier.residual, dossier.displacement);
  }
  total.reset();
  results->close(summary);

  if (completed) {
    tell_result(recorder, progress);
    progress.say(fmt::format("completed in {:.2f} s: {} steps, {} factorisations; results in {}",
                             summary.seconds.total, result.steps, summary.factorisations,
                             from.output.directory.string()));
    return Exit::done;
  }
  progress.problem(summary.reason);
  progress.problem(
      fmt::format("{} accepted steps are in {}", result.steps, from.output.directory.string()));
  if (!interrupted) progress.problem("dossier.txt there tells where it failed and what to do");
  if (interrupted) return Exit::interrupted;
  return result.outcome == Outcome::out_of_memory ? Exit::out_of_memory : Exit::not_converged;
}

}  // namespace

Exit run(const Case& from, const RunOptions& options) {
  make_write_faults_errors();
  Progress progress(options.quiet, options.log_file);
  Summary summary;
  std::optional<Results> results;
  try {
    return located_errors(from,
                          [&] { return run_case(from, options, progress, summary, results); });
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
