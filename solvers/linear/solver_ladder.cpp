#include "solvers/linear/solver_ladder.hpp"

#include <fmt/format.h>

namespace peristat {
namespace {

/// True if another solver may do better: the outcome is not about the tangent.
bool is_the_solvers_own(LinearOutcome outcome) {
  return outcome == LinearOutcome::inaccurate || outcome == LinearOutcome::out_of_memory;
}

}  // namespace

SolverLadder::SolverLadder(std::vector<Rung> rungs, Reporter tell)
    : rungs_(std::move(rungs)), report_(std::move(tell)) {}

LinearOutcome SolverLadder::stand_on(std::size_t rung) {
  if (solver_) before_ = statistics();
  rung_ = rung;
  solver_ = rungs_[rung].make();
  solver_->count_pivots(counts_pivots_);
  return solver_->analyze(*pattern_, *free_);
}

LinearOutcome SolverLadder::climb_down(LinearOutcome why) {
  while (is_the_solvers_own(why) && rung_ + 1 < rungs_.size()) {
    const std::string from = rungs_[rung_].name, ended = name(why);
    why = stand_on(rung_ + 1);
    if (report_)
      report_(fmt::format("{} ended with {}: {} from now on", from, ended, rungs_[rung_].name));
  }
  return why;
}

LinearOutcome SolverLadder::analyze(const BlockPattern& pattern, const FreeDofs& free) {
  pattern_.emplace(pattern);
  free_ = &free;
  // A second call means that fragments were pinned: a rung that failed before would fail again.
  return climb_down(stand_on(rung_));
}

void SolverLadder::count_pivots(bool counts) {
  counts_pivots_ = counts;
  if (solver_) solver_->count_pivots(counts);
}

LinearOutcome SolverLadder::factorize(const TangentOperator& tangent, FactorUse use) {
  tangent_ = &tangent;
  LinearOutcome outcome = LinearOutcome::solved;
  if (tangent.version != version_) {
    version_ = tangent.version;
    outcome = analyze(tangent.pattern, *free_);
  }
  if (outcome == LinearOutcome::solved) outcome = solver_->factorize(tangent, use);
  while (is_the_solvers_own(outcome) && rung_ + 1 < rungs_.size()) {
    outcome = climb_down(outcome);
    if (outcome == LinearOutcome::solved) outcome = solver_->factorize(tangent, use);
  }
  return outcome;
}

LinearOutcome SolverLadder::solve(std::span<const double> b, std::span<double> x,
                                  double tolerance) {
  LinearOutcome outcome = solver_->solve(b, x, tolerance);
  while (is_the_solvers_own(outcome) && rung_ + 1 < rungs_.size()) {
    outcome = climb_down(outcome);
    if (outcome == LinearOutcome::solved) {
      outcome = solver_->factorize(*tangent_, FactorUse::factorize_now);
    }
    if (outcome == LinearOutcome::solved) outcome = solver_->solve(b, x, tolerance);
  }
  return outcome;
}

std::optional<Inertia> SolverLadder::inertia() const { return solver_->inertia(); }

LinearStatistics SolverLadder::statistics() const {
  LinearStatistics sum = solver_ ? solver_->statistics() : LinearStatistics{};
  sum.factorisations += before_.factorisations;
  sum.iterations += before_.iterations;
  sum.seconds += before_.seconds;
  return sum;
}

int SolverLadder::last_iterations() const { return solver_->last_iterations(); }
std::string SolverLadder::describe() const { return solver_->describe(); }

}  // namespace peristat
