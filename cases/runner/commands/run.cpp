#include "cases/runner/commands/run.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>

#include <H5public.h>
#include <fmt/format.h>

#include "assembly/borne_stretches.hpp"
#include "cases/runner/commands/run_facts.hpp"
#include "cases/runner/input/case_inputs.hpp"
#include "cases/runner/process/failure.hpp"
#include "cases/runner/process/interruption.hpp"
#include "cases/runner/process/ranks_environment.hpp"
#include "cases/runner/process/runtime_environment.hpp"
#include "cases/runner/results/dossier.hpp"
#include "cases/runner/results/recorder.hpp"
#include "cases/runner/results/results.hpp"
#include "cases/runner/results/sensitivities.hpp"
#include "cases/runner/results/tables/constraint_columns.hpp"
#include "cases/runner/results/tables/crack_tip_columns.hpp"
#include "cases/runner/results/tables/driven_sets.hpp"
#include "cases/runner/results/tables/fatigue_columns.hpp"
#include "cases/runner/results/tables/motion_columns.hpp"
#include "cases/runner/setup/body.hpp"
#include "cases/runner/setup/lattice_rows.hpp"
#include "cases/runner/setup/part_body.hpp"
#include "cases/runner/setup/preflight.hpp"
#include "cases/runner/setup/preflight_rules.hpp"
#include "cases/runner/setup/solver_options.hpp"
#include "solvers/body/body_memory.hpp"
#include "solvers/body/describe_body.hpp"
#include "solvers/linear/cholesky.hpp"
#include "solvers/linear/lu_factor.hpp"
#include "solvers/observe/recorded_points.hpp"
#include "solvers/ranks/part_bonds.hpp"
#include "solvers/study/crack_trapping.hpp"
#include "solvers/study/found_loads.hpp"
#include "solvers/study/study.hpp"
#include "src/core/input_error.hpp"
#include "src/core/stopwatch.hpp"
#include "src/parallel/communicator.hpp"
#include "src/potentials/make_saw_tooth.hpp"

namespace peristat {
namespace {

std::vector<LineTable> lines_of(const Case& from) {
  std::vector<LineTable> lines;
  for (const ProbeSpecification& probe : from.probes) {
    if (probe.from) lines.push_back(line_table(probe, from.dimension));
  }
  return lines;
}

/// Fills in the summary's counts before the first step.
void count(const Body& body, const FreeDofs& free, const RunOptions& options,
           const Communicator& ranks, Summary& summary) {
  summary.points = Index(body.index_map->whole());
  summary.free_dofs = ranks.count_all(free.count()).all;
  const bool is_whole = body.index_map->is_whole();
  for (const auto& term : body.model.terms()) {
    for (const InteractionCount& kind : term->counts()) {
      summary.count(kind.name,
                    is_whole ? kind.count : count_interactions(body.points, kind, ranks));
    }
  }
  if (!is_whole) {
    summary.count("bonds", count_bonds(body.points, body.model.bonds(), ranks));
  }
  summary.costs.seconds.neighbourhood += body.seconds_neighbourhood;
  summary.threads = options.threads;
  summary.ranks = ranks.count();
}

std::unique_ptr<SolvedModel> solved_stand_in(const Case& from, const Study& study,
                                             const Model& stand_in) {
  const Points& points = study.body().points;
  BodySize size = size_of(points);
  size.horizon_ratio = reach_ratio(from.volume_correction, from.horizon_shape, from.dimension,
                                   from.solver.elastic_horizon_ratio);
  size.bonds = double(stand_in.bonds().count());
  size.free_dofs = double(study.free().count());
  const Body& body = study.body();
  LinearSystems systems =
      body.index_map->is_whole()
          ? choose_linear_systems(study.options(), stand_in, estimate_memory(size),
                                  box_for_sines(study.options(), body), {})
          : choose_linear_systems(study.options(), body, {});
  return std::make_unique<SolvedModel>(points, stand_in, body.conditions->constraints(),
                                       study.free(), std::move(systems), study.options().threads,
                                       *body.index_map);
}

/// Title and file of the case. A case of a program has no file, but a name in its place.
std::string heading_of(const Case& from) {
  std::error_code error;
  if (from.title.empty()) return from.file;
  if (!std::filesystem::exists(from.file, error)) return from.title;
  return fmt::format("{} ({})", from.title, from.file);
}

LoadSteppingResult out_of_memory() {
  LoadSteppingResult result;
  result.outcome = Outcome::out_of_memory;
  return result;
}

}  // namespace

std::map<std::string, std::string> versions() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return {{"peristat", PERISTAT_VERSION},
          {"hdf5", fmt::format("{}.{}.{}", major, minor, release)},
          {"cholmod", Cholesky::library_version()},
          {"umfpack", LuFactor::library_version()},
          {"compiler", fmt::format("GCC {}", __VERSION__)}};
}

namespace {

/// A run of a case, step by step.
class CaseRun {
 public:
  /// @param earlier run to resume; null: start from rest
  /// @param results is made as soon as the case has been checked
  CaseRun(const Case& from, const RunOptions& options, const Communicator& ranks,
          EarlierRun* earlier, Progress& progress, Summary& summary,
          std::optional<Results>& results)
      : from_(from),
        options_(options),
        ranks_(ranks),
        earlier_(earlier),
        progress_(progress),
        summary_(summary),
        results_(results),
        support_sets_(support_sets(from)),
        probes_(columns_of(driven_by(from))) {
    for (const auto& probe : from.probes) {
      if (!probe.from) probes_.push_back(columns_of(probe, from.dimension));
    }
    for (ProbeColumns& columns : crack_tip_columns(from)) probes_.push_back(std::move(columns));
    for (ProbeColumns& columns : constraint_columns(from)) probes_.push_back(std::move(columns));
    for (ProbeColumns& columns : motion_columns(from)) probes_.push_back(std::move(columns));
    for (ProbeColumns& columns : fatigue_columns(from)) probes_.push_back(std::move(columns));
  }

  Exit run() {
    progress_.say(heading_of(from_));
    if (earlier_) summary_.costs = earlier_->checkpoint().costs;
    make();
    if (!options_.company) heed_interruptions();
    open_results();
    LoadSteppingResult result = follow();
    conclude(result);
    results_->close(summary_);
    const Exit exit = tell(result);
    if (options_.company && options_.company->ended) {
      options_.company->ended(body_, std::move(result));
    }
    return exit;
  }

 private:
  /// Makes body, equations and their solver; refuses cases that can't be run.
  void make() {
    if (options_.company) body_ = options_.company->body;
    if (!body_) {
      body_ = ranks_.count() > 1 ? make_part_body(from_, ranks_, options_.threads)
                                 : make_body(from_, options_.threads);
    }
    keep_freed_memory_of_small_bodies(is_small(body_->points));
    gathering_.emplace(*body_->index_map);
    further_ = {from_.output.stress, lines_of(from_), !from_.controls.empty(),
                !from_.sensitivity.over.empty()};
    study_.emplace(*body_, study_options(from_, options_.threads),
                   [this](const std::string& reason) { recorder_->changed_solver(reason); });
    if (!gathering_->is_whole()) {
      recorded_.emplace(body_->points, *body_->index_map);
      numbering_.emplace(*recorded_, *gathering_, body_->model, body_->conditions->prescribed());
    }
    make_sensitivities();
    if (earlier_) {
      earlier_results_ = earlier_->results(support_sets_, probes_, further_.lines);
      earlier_->load(numbering());
      require_body_of(*earlier_);
      require_functions_of(*earlier_);
      earlier_->find_followers(study_->equations().assembler());
    }
    count(*body_, study_->free(), options_, ranks_, summary_);
    tell_size();
    const Preflight preflight =
        located_errors(from_, [&] { return preflight_of(from_, *body_, ranks_); });
    for (const auto& [label, fact] : preflight_lines(preflight)) {
      preflight_ += fmt::format("{}: {}\n", label, fact);
    }
    summary_.warnings = warnings_of(preflight);
    may_lock_ = has_rows_to_lock_to(from_);
    for (const std::string& warning : summary_.warnings) progress_.say("warning: " + warning);
    // Loads that can't be found are refused before results are touched.
    if (finds_loads(study_->options(), *body_->conditions)) study_->analyze();
    if (from_.dynamics.is_asked_for) describe_motion();
    progress_.follow_to(body_->conditions->programme().end());
    crack_tips_ = located_errors(
        from_, [&] { return make_crack_tips(*body_, from_.crack_tips, study_->options()); });
  }

  void make_sensitivities() {
    if (from_.sensitivity.over.empty()) return;
    if (earlier_) {
      throw InputError("sensitivity.over", "",
                       "can't be resumed: the bodies beside the run are not in its checkpoint; run "
                       "the case anew with --overwrite");
    }
    sensitivities_ = std::make_unique<Sensitivities>(from_, *study_, support_sets_, probes_);
  }

  void tell_size() {
    const std::int64_t bonds =
        numbering_ ? summary_.counted("bonds") : body_->model.failure().count_of_bonds();
    const std::string of_ranks =
        numbering_ ? fmt::format("{} ranks with {} threads each", ranks_.count(), options_.threads)
                   : fmt::format("{} threads", options_.threads);
    progress_.say(fmt::format("{} points, {} bonds, {} free degrees of freedom, {}",
                              summary_.points, bonds, summary_.free_dofs, of_ranks));
    if (numbering_) {
      const double most = ranks_.max(double(body_->index_map->owned()));
      const double ghosts = ranks_.sum(double(body_->points.count() - body_->index_map->owned()));
      progress_.say(fmt::format("at most {:.0f} points on a rank, {:.0f} ghosts", most, ghosts));
    } else {
      for (const std::string& line : describe_interactions(*body_)) progress_.say(line);
    }
  }

  /// Refuses a step that is not stable before results are touched.
  void describe_motion() {
    if (earlier_) return;
    const Stiffness& stiffness = study_->find_initial_stiffness();
    progress_.say(fmt::format("stable {}time step: {:.6g} s",
                              from_.dynamics.is_implicit() ? "explicit " : "",
                              stiffness.stable_step()));
  }

  /// @throws InputError if the body is another one
  void require_body_of(const EarlierRun& earlier) {
    const auto refuse = [&](const std::string& why) {
      throw InputError("", "", why, earlier.directory().string());
    };
    const auto all_say = [&](bool holds) { return ranks_.min(double(holds)) > 0.0; };
    if (!all_say(
            earlier.has_points(only_recorded({body_->points, *body_->index_map}), *gathering_))) {
      refuse("its points differ from those that the case now makes");
    }
    if (!all_say(is_of_body(earlier.checkpoint().path, study_->equations().assembler(),
                            body_->conditions->prescribed()))) {
      refuse("its checkpoint belongs to another body");
    }
  }

  /// Given functions may have changed since the run began: the supports must stand where it left
  /// them.
  /// @throws InputError
  void require_functions_of(const EarlierRun& earlier) const {
    if (from_.givens->functions.empty()) return;
    const State& accepted = earlier.checkpoint().path.accepted;
    std::vector<double> supported = accepted.displacement;
    body_->conditions->prescribe(load_point(accepted), supported);
    double largest = 0.0, difference = 0.0;
    for (std::size_t dof = 0; dof < supported.size(); ++dof) {
      largest = std::max(largest, std::abs(accepted.displacement[dof]));
      difference = std::max(difference, std::abs(supported[dof] - accepted.displacement[dof]));
    }
    constexpr double round_off = 1e-9;
    if (difference <= round_off * largest) return;
    throw InputError(
        "", "",
        fmt::format("the functions of its supports have changed: at the load that the run has "
                    "reached their displacements differ by {:.3g} m from those of the run",
                    difference),
        earlier.directory().string());
  }

  void open_results() {
    Assembler& assembler = study_->equations().assembler();
    const CaseText text{
        from_.as_read,  from_.as_resolved,         from_.title, versions(), identity(from_.file),
        from_.settings, checksums_of_files(from_), preflight_};
    const Points points = only_recorded({body_->points, *body_->index_map});
    if (earlier_) {
      results_.emplace(*earlier_, earlier_results_, points, text, support_sets_, probes_, further_,
                       numbering());
      recorder_.emplace(from_, *body_, assembler, *results_, progress_, crack_tips_);
      recorder_->go_on(earlier_->checkpoint(), earlier_results_, support_sets_, probes_);
      earlier_results_ = {};
      tell_beginning();
    } else {
      results_.emplace(from_.output.directory, points, text, support_sets_, probes_,
                       constant_fields_of(from_, *body_), options_.overwrite, further_,
                       *gathering_);
      recorder_.emplace(from_, *body_, assembler, *results_, progress_, crack_tips_);
    }
    if (sensitivities_) sensitivities_->open(from_.output.directory);
    if (ranks_.rank() == 0) leave_note(from_.output.directory);
  }

  void tell_beginning() {
    if (!earlier_->remark().empty()) progress_.problem(earlier_->remark());
    const PathState& path = earlier_->checkpoint().path;
    progress_.say(fmt::format("continuing after step {}, load factor {:.6g}", path.steps,
                              body_->conditions->load_factor(load_point(path.accepted))));
  }

  LoadSteppingResult follow() {
    SolvedModel& equations = study_->equations();
    study_->analyze();
    if (!from_.dynamics.is_asked_for || from_.dynamics.searches())
      progress_.say(fmt::format("linear solver: {}{} ({})", equations.solver().describe(),
                                equations.systems().is_stored ? "" : ", tangent matrix-free",
                                equations.systems().chosen.reason));
    if (const BondFailure* bonds = body_->model.failing_bonds()) {
      const ToothedStrength teeth = toothed_strength(bonds->potential());
      if (teeth.teeth > 0) progress_.say("damage law: a saw-tooth of " + description(teeth));
    }
    const Points& points = body_->points;
    if (const auto trapping = crack_trapping(body_->specification, points.dimension,
                                             body_->setting.horizon / body_->horizon_ratio())) {
      progress_.say("damage law: " + description(*trapping));
    }
    const PathState* path = earlier_ ? &earlier_->checkpoint().path : nullptr;
    stand_in_ = make_elastic_stand_in(from_, *body_, options_.threads);
    if (!stand_in_) return study_->follow(observer(), nullptr, path);
    standing_in_ = solved_stand_in(from_, *study_, *stand_in_);
    if (standing_in_->analyze() != LinearOutcome::solved) return out_of_memory();
    const SolvedBody solved = standing_in_->solved();
    return study_->follow(observer(), &solved, path);
  }

  LoadSteppingObserver observer() {
    LoadSteppingObserver told;
    told.iteration = [this](const IterationRecord& record) { recorder_->iteration(record); };
    told.decision = [this](const DecisionRecord& record) { recorder_->decided(record); };
    if (sensitivities_) {
      told.commits = [this](const UncommittedState& state) { sensitivities_->follow(state); };
    }
    told.accepted = [this](const StepRecord& record, const AcceptedState& state) {
      recorder_->accepted(record, state);
      if (sensitivities_) warn(sensitivities_->add(*recorder_->last(), state));
      overload_ = std::max(overload_, record.overload);
      if (may_lock_) note_tips(*recorder_->last());
      summary_.max_displacement = largest_of_all(state.trial.displacement);
      if (record.step > 0) ++steps_here_;
      if (options_.company && options_.company->accepted) {
        options_.company->accepted({*recorder_->last(), state, *body_,
                                    study_->equations().assembler(), from_.output.count_cracks});
      }
    };
    told.reached = [this](const PathState& state) {
      const Stopwatch watch(seconds_of_checkpoints_);
      Checkpoint checkpoint = recorder_->checkpoint(state);
      checkpoint.costs = costs(state.relaxation_seconds);
      results_->add_checkpoint(std::move(checkpoint), numbering());
    };
    told.describe = [this](const InputError& error) {
      return std::string(located(from_, error).what());
    };
    told.interrupted = [this] {
      const bool here = is_asked_to_stop() || (options_.steps > 0 && steps_here_ >= options_.steps);
      return ranks_.count() == 1 ? here : ranks_.max(double(here)) > 0.0;
    };
    return told;
  }

  [[nodiscard]] bool is_asked_to_stop() const {
    if (!options_.company) return interruption_requested();
    return options_.company->interrupted && options_.company->interrupted();
  }

  /// Null for a whole body.
  [[nodiscard]] StateNumbering* numbering() { return numbering_ ? &*numbering_ : nullptr; }

  [[nodiscard]] double largest_of_all(const std::vector<double>& displacement) const {
    return ranks_.max(largest_displacement(displacement, body_->points));
  }

  /// Costs of this session and earlier ones.
  RunCosts costs(double relaxation_seconds) {
    RunCosts costs = summary_.costs;
    add_costs(study_->equations(), costs);
    if (standing_in_) add_costs(*standing_in_, costs);
    costs.seconds.total += std::chrono::duration<double>(Clock::now() - start_).count();
    costs.seconds.relaxation = relaxation_seconds;
    costs.seconds.output = results_->seconds_spent();
    costs.seconds.checkpoints += seconds_of_checkpoints_;
    return costs;
  }

  /// Completes the summary after the last step, and writes the dossier of a failure.
  void conclude(const LoadSteppingResult& result) {
    summary_.status = status_of(result.outcome);
    if (result.outcome != Outcome::converged) {
      const double reached = body_->conditions->load_factor(load_point(result.state));
      const bool moves = from_.solver.mode == Mode::dynamics;
      const std::string where = place_of_failure(result, reached, moves, recorder_->last());
      summary_.reason = failure_reason(result, where, recorder_->decisions());
    } else if (!recorder_->decisions().empty() &&
               recorder_->decisions().back().action == Decision::stop) {
      summary_.reason = recorder_->decisions().back().reason;  // it ended before its load
    }
    summary_.max_displacement = largest_of_all(result.state.displacement);
    warn_of_numerical_work();
    warn_of_overload();
    warn_of_locking();
    if (result.outcome == Outcome::converged) warn_of_idle_obstacles();
    recorder_->finish();
    summary_.costs = costs(result.relaxation_seconds);
    if (numbering_) tell_traffic();
    if (result.outcome == Outcome::converged || result.outcome == Outcome::interrupted) return;
    const Dossier dossier =
        make_dossier(from_, *body_, result, recorder_->last(), recorder_->decisions());
    results_->add_dossier(dossier.text, dossier.residual, dossier.displacement);
  }

  /// @param of empty: nothing
  void warn(const std::string& of) {
    if (of.empty()) return;
    summary_.warnings.push_back(of);
    progress_.say("warning: " + of);
  }

  /// Warns of steps so large that relaxation itself has supplied most of the energy: forces between
  /// them, and so a peak, have not been seen. In steps that follow the damage it supplies some per
  /// cent.
  void warn_of_numerical_work() {
    constexpr double most = 2.0;  // times the external work
    const std::optional<StepRecord>& last = recorder_->last();
    if (!last || !(last->numerical_work > most * std::abs(last->external_work))) return;
    warn(fmt::format(
        "the iterations of relaxation have done {:.3g} times the work of loads and supports: steps "
        "went far beyond the onset of damage, and the largest force is not a peak of the body; "
        "give "
        "more steps (loading.steps, relaxation.steps) or a smaller load",
        last->numerical_work / std::max(std::abs(last->external_work), 1e-300)));
  }

  /// Warns of steps that have driven bonds far past what they bear before any was damaged: their
  /// softening has not been followed, and what they have set free beyond it is drained.
  void warn_of_overload() {
    // Bonds that soften are beyond their onset in every step; brittle ones need not be.
    const double most = fails_by_steps(body_->model) ? 1.05 : 1.3;
    if (!(overload_ > most)) return;
    warn(fmt::format(
        "a step has driven bonds to {:.3g} times what they bear before it damaged any: the largest "
        "force and the drained energy depend on the steps; give more steps (loading.steps)",
        overload_));
  }

  /// Keeps the lowest T* of each tip in mixed mode, while the integrals about it mean something.
  void note_tips(const StepRecord& record) {
    constexpr double most_spread = 0.1;
    for (const CrackTipSpecification& tip : from_.crack_tips) {
      const auto value = [&](const char* of) {
        const auto found = record.probes.find(tip.name + of);
        return found == record.probes.end() ? 0.0 : found->second.front();
      };
      const double t_star = value("_T_star"), k1 = value("_K1"), k2 = value("_K2");
      const bool turns = std::abs(k2) > turning_share * std::hypot(k1, k2);
      if (!turns || !(t_star < locking_t_star) || value("_J_spread") > most_spread) continue;
      const auto known = lowest_t_star_.find(tip.name);
      if (known != lowest_t_star_.end() && known->second[0] <= t_star) continue;
      lowest_t_star_[tip.name] = {t_star, k1, k2, record.load_factor};
    }
  }

  void warn_of_idle_obstacles() {
    for (const ObstacleSpecification& obstacle : from_.obstacles) {
      if (!recorder_->last() || recorder_->has_pressed(obstacle.name)) continue;
      warn(
          fmt::format("the obstacle {} has touched nothing in the whole run, so it has had no "
                      "effect; check its place, its displacement and its set",
                      obstacle.name));
    }
  }

  void warn_of_locking() {
    for (const auto& [name, lowest] : lowest_t_star_) {
      const auto& [t_star, k1, k2, load] = lowest;
      warn(fmt::format(
          "crack tip {}: T* = {:.2g} in mixed mode, K_I = {:.3g} and K_II = {:.3g} Pa m^0.5, at "
          "load factor {:.4g}: below {:g} a crack locks to a row of a lattice and turns too "
          "little; points without rows are lattice.points = \"blue_noise\", or those "
          "of a file, and T* falls with the root of the horizon, which lattice.refine makes short",
          name, t_star, k1, k2, load, locking_t_star));
    }
  }

  /// Prints the traffic between ranks, in counts that do not depend on the machine.
  void tell_traffic() {
    const Traffic mine = body_->index_map->traffic();
    const double exchanges = std::max(1.0, double(mine.exchanges));
    const double messages = ranks_.sum(double(mine.messages)) / exchanges;
    const double bytes = ranks_.sum(double(mine.bytes)) / exchanges;
    progress_.say(fmt::format("ghosts exchanged {} times: {:.0f} messages, {:.0f} bytes each",
                              mine.exchanges, messages, bytes));
  }

  Exit tell(const LoadSteppingResult& result) {
    const std::string folder = from_.output.directory.string();
    if (result.outcome == Outcome::converged) {
      report_result(recorder_->last(), progress_);
      progress_.say(fmt::format("completed in {:.2f} s: {} steps, {} factorisations; results in {}",
                                summary_.costs.seconds.total, result.steps,
                                summary_.costs.factorisations, folder));
      return Exit::done;
    }
    progress_.problem(summary_.reason);
    progress_.problem(fmt::format("{} accepted steps are in {}", result.steps, folder));
    if (result.outcome == Outcome::interrupted) {
      if (recorder_->last()) progress_.problem("to continue: peristat resume " + folder);
      return Exit::interrupted;
    }
    progress_.problem("dossier.txt there describes where it failed and what to do");
    return result.outcome == Outcome::out_of_memory ? Exit::out_of_memory : Exit::not_converged;
  }

  using Clock = std::chrono::steady_clock;

  const Case& from_;
  const RunOptions& options_;
  const Communicator& ranks_;
  EarlierRun* const earlier_;
  Progress& progress_;
  Summary& summary_;
  std::optional<Results>& results_;
  const std::vector<std::string> support_sets_;
  std::vector<ProbeColumns> probes_;
  std::string preflight_;
  FurtherOutput further_;
  const Clock::time_point start_ = Clock::now();
  EarlierResults earlier_results_;  // until results_ takes them over
  double seconds_of_checkpoints_ = 0.0;
  int steps_here_ = 0;                                          // accepted in this session
  double overload_ = 0.0;                                       // the largest of its steps
  bool may_lock_ = false;                                       // cracks to the rows of a lattice
  std::map<std::string, std::array<double, 4>> lowest_t_star_;  // of tips, with K_I, K_II and load
  std::shared_ptr<const Body> body_;
  // With several ranks only.
  std::optional<RowGathering> gathering_;
  std::optional<RecordedPoints> recorded_;
  std::optional<StateNumbering> numbering_;
  std::optional<Study> study_;
  std::optional<Model> stand_in_;
  std::unique_ptr<SolvedModel> standing_in_;
  std::vector<CrackTip> crack_tips_;
  std::optional<Recorder> recorder_;
  std::unique_ptr<Sensitivities> sensitivities_;  // null: not asked for
};

}  // namespace

Exit run(const Case& from, const RunOptions& options, const Communicator& ranks,
         EarlierRun* earlier) {
  if (!options.company) make_write_faults_errors();
  keep_inputs_and_log_apart(from, options.log_file);
  const bool tells = ranks.rank() == 0;
  Progress progress(options.quiet, options.log_file, tells,
                    options.company ? options.company->line : Progress::Sink());
  Summary summary;
  std::optional<Results> results;
  try {
    return located_errors(from, [&] {
      return CaseRun(from, options, ranks, earlier, progress, summary, results).run();
    });
  } catch (...) {
    if (!results) throw;
    const Failure failure = current_failure();
    if (ranks.count() > 1) give_way_to_first(ranks);
    results->fail(summary, failure.message);
    if (ranks.count() > 1) {
      say_last_words(fmt::format("peristat: {}\n{}\n", failure.message, results->what_is_left()));
      ranks.abort(static_cast<int>(failure.code));
    }
    if (!options.company) progress.problem(failure.message);  // else the exception tells it
    progress.problem(results->what_is_left());
    if (options.company) {
      if (failure.code == Exit::out_of_memory) results->abandon();
      throw;
    }
    if (failure.code == Exit::out_of_memory) {
      // After a failed allocation HDF5 can't close its objects: that would end in a segmentation
      // fault.
      std::fflush(nullptr);
      std::_Exit(static_cast<int>(failure.code));
    }
    return failure.code;
  }
}

}  // namespace peristat
