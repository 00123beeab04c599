#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/setup/body.hpp"
#include "cases/runner/setup/solver_options.hpp"
#include "solvers/linear/cholesky.hpp"

namespace peristat {

/// A shipped case, solved inside the test, with the records that tests check.
struct SolvedCase {
  Case from;
  std::unique_ptr<const Body> body;
  LoadSteppingResult result;
  std::vector<IterationRecord> iterations;
  std::vector<StepRecord> steps;

  /// Mean of a component of the displacement over a set [m].
  [[nodiscard]] double mean_displacement(const std::string& set, int component) const {
    const std::vector<Index>& members = body->points.sets.at(set);
    double sum = 0.0;
    for (Index i : members) {
      sum += result.state.displacement[std::size_t(i) * body->points.dimension + component];
    }
    return sum / double(members.size());
  }
};

/// Solves cases/NAME with overrides, as `peristat run` does.
inline SolvedCase solve_case(const std::string& name,
                             const std::vector<std::pair<std::string, std::string>>& overrides = {},
                             int threads = 2) {
  SolvedCase solved;
  solved.from = read_case(std::string(PERISTAT_SOURCE_DIR "/cases/") + name, overrides);
  solved.body = make_body(solved.from, threads);
  const FreeDofs free(solved.body->conditions->prescribed(), solved.from.dimension);
  Assembler assembler(solved.body->points, solved.body->model, threads);
  const BlockPattern pattern(solved.body->model.bonds());
  Tangent tangent(assembler);
  Cholesky solver;
  if (solver.analyze(pattern, free) != LinearOutcome::solved) {
    solved.result.outcome = Outcome::out_of_memory;
    return solved;
  }
  LoadSteppingObserver observer;
  observer.iteration = [&](const IterationRecord& row) { solved.iterations.push_back(row); };
  observer.accepted = [&](const StepRecord& row, const AcceptedState&) {
    if (row.step > 0) solved.steps.push_back(row);
  };
  solved.result = follow_loading({{assembler, solver, tangent, free},
                                  *solved.body->conditions,
                                  load_stepping_options(solved.from),
                                  newton_options(solved.from),
                                  observer});
  return solved;
}

}  // namespace peristat
