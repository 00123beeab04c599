#include "cases/runner/commands/run_on_ranks.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "cases/runner/build/part_body.hpp"
#include "cases/runner/build/solver_options.hpp"
#include "cases/runner/commands/run_facts.hpp"
#include "cases/runner/process/failure.hpp"
#include "cases/runner/process/interruption.hpp"
#include "cases/runner/results/motion_columns.hpp"
#include "cases/runner/results/part_recorder.hpp"
#include "cases/runner/results/probe.hpp"
#include "cases/runner/results/results.hpp"
#include "solvers/ranks/part_bonds.hpp"

namespace peristat {
namespace {

/// The points that a rank owns, without ghosts.
Points owned_points(const Points& points) {
  Points owned = points;
  const Index count = points.owned.value_or(points.count());
  owned.reference.resize(std::size_t(count) * std::size_t(points.dimension));
  owned.volume.resize(std::size_t(count));
  for (auto& [name, members] : owned.sets) {
    std::erase_if(members, [&](Index point) { return point >= count; });
  }
  return owned;
}

/// A run of a case, step by step; all ranks take the same.
class RanksRun {
 public:
  RanksRun(const Case& from, const RunOptions& options, const Communicator& ranks)
      : from_(from),
        options_(options),
        ranks_(ranks),
        is_first_(ranks.rank() == 0),
        progress_(options.quiet || !is_first_, is_first_ ? options.log_file : "") {}

  Exit run() {
    progress_.say(from_.title.empty() ? from_.file
                                      : fmt::format("{} ({})", from_.title, from_.file));
    make();
    heed_interruptions();
    open_results();
    progress_.say(fmt::format("linear solver: {}, tangent matrix-free ({})",
                              study_->equations().solver().describe(),
                              study_->equations().systems().chosen.reason));
    const LoadSteppingResult result = study_->follow(observer());
    conclude(result);
    if (results_) results_->close(summary_);
    return tell(result);
  }

  /// Leaves in the results that the exception which is being handled has ended them.
  void note_failure() {
    if (results_) results_->fail(summary_, current_failure().message);
  }

 private:
  void make() {
    body_ = make_part_body(from_, ranks_, options_.threads);
    located_errors(from_, [&] { study_.emplace(*body_, study_options(from_, options_.threads)); });
    gathering_.emplace(*body_->part);
    summary_.points = Index(body_->part->whole());
    summary_.free_dofs = ranks_.count_all(study_->free().count()).all;
    const GlobalIndex bonds = count_bonds(body_->part->owned(), body_->model.bonds(), ranks_);
    summary_.count("bonds", bonds);
    summary_.costs.seconds.neighbourhood += body_->seconds_neighbourhood;
    summary_.threads = options_.threads;
    summary_.ranks = ranks_.count();
    progress_.say(fmt::format(
        "{} points, {} bonds, {} free degrees of freedom, {} ranks with {} threads each",
        summary_.points, bonds, summary_.free_dofs, ranks_.count(), options_.threads));
    const double most = ranks_.max(double(body_->part->owned()));
    const double ghosts = ranks_.sum(double(body_->points.count() - body_->part->owned()));
    progress_.say(fmt::format("at most {:.0f} points on a rank, {:.0f} ghosts", most, ghosts));
    if (from_.dynamics.is_asked_for) {
      // Refuses a step that is not stable before results are touched.
      const Stiffness& stiffness = study_->find_initial_stiffness();
      progress_.say(fmt::format("stable {}time step: {:.6g} s",
                                from_.dynamics.is_implicit() ? "explicit " : "",
                                stiffness.stable_step()));
    }
    progress_.follow_to(body_->conditions->programme().end());
  }

  void open_results() {
    const Points points = owned_points(body_->points);
    const std::vector<PointCounts> counts = constant_fields_of(*body_);
    if (is_first_) {
      const CaseText text{from_.as_read, from_.as_resolved,    from_.title,
                          versions(),    identity(from_.file), from_.settings};
      located_errors(from_, [&] {
        results_.emplace(from_.output.directory, points, text, support_sets(from_), probe_columns(),
                         counts, options_.overwrite, FurtherOutput(), &*gathering_);
      });
      leave_note(from_.output.directory);
    } else {
      send_points(points, counts, *gathering_);
    }
    recorder_.emplace(from_, *body_, study_->equations().assembler(), *gathering_,
                      results_ ? &*results_ : nullptr, progress_);
  }

  [[nodiscard]] std::vector<ProbeColumns> probe_columns() const {
    std::vector<ProbeColumns> columns;
    for (const ProbeSpecification& probe : from_.probes) {
      columns.push_back(columns_of(probe, from_.dimension));
    }
    for (ProbeColumns& of_motion : motion_columns(from_)) columns.push_back(std::move(of_motion));
    return columns;
  }

  LoadSteppingObserver observer() {
    LoadSteppingObserver told;
    told.iteration = [this](const IterationRecord& record) { recorder_->iteration(record); };
    told.decision = [this](const DecisionRecord& record) { recorder_->decided(record); };
    told.accepted = [this](const StepRecord& record, const AcceptedState& state) {
      recorder_->accepted(record, state);
      ++steps_;
    };
    told.describe = [this](const InputError& error) {
      return std::string(located(from_, error).what());
    };
    told.interrupted = [this] {
      const bool here =
          interruption_requested() || (options_.steps > 0 && steps_ >= options_.steps);
      return ranks_.max(double(here)) > 0.0;
    };
    return told;
  }

  void conclude(const LoadSteppingResult& result) {
    summary_.status = status_of(result.outcome);
    if (result.outcome != Outcome::converged) {
      const double reached = body_->conditions->load_factor(load_point(result.state));
      summary_.reason = failure_reason(result, reached);
    }
    summary_.max_displacement =
        ranks_.max(largest_displacement(result.state.displacement, body_->points));
    recorder_->finish();
    add_costs(study_->equations(), summary_.costs);
    summary_.costs.seconds.total = std::chrono::duration<double>(Clock::now() - start_).count();
    if (results_) summary_.costs.seconds.output = results_->seconds_spent();
    tell_traffic();
  }

  /// What ranks send to one another, as counts that do not depend on the machine.
  void tell_traffic() {
    const Traffic mine = body_->part->traffic();
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
      progress_.say(fmt::format("completed in {:.2f} s: {} steps; results in {}",
                                summary_.costs.seconds.total, result.steps, folder));
      return Exit::done;
    }
    if (is_first_) {
      progress_.problem(summary_.reason);
      progress_.problem(fmt::format("{} accepted steps are in {}", result.steps, folder));
    }
    if (result.outcome == Outcome::interrupted) return Exit::interrupted;
    return result.outcome == Outcome::out_of_memory ? Exit::out_of_memory : Exit::not_converged;
  }

  using Clock = std::chrono::steady_clock;

  const Case& from_;
  const RunOptions& options_;
  const Communicator& ranks_;
  const bool is_first_;
  const Clock::time_point start_ = Clock::now();
  Progress progress_;
  Summary summary_;
  int steps_ = 0;  // accepted
  std::unique_ptr<const Body> body_;
  std::optional<Study> study_;
  std::optional<RowGathering> gathering_;
  std::optional<Results> results_;  // of rank 0
  std::optional<PartRecorder> recorder_;
};

}  // namespace

Exit run_on_ranks(const Case& from, const RunOptions& options, const Communicator& ranks) {
  make_write_faults_errors();
  RanksRun run(from, options, ranks);
  try {
    return located_errors(from, [&] { return run.run(); });
  } catch (...) {
    run.note_failure();
    throw;
  }
}

}  // namespace peristat
