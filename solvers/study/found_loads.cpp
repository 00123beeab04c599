#include "solvers/study/found_loads.hpp"

#include <vector>

#include "solvers/search/bordered_newton.hpp"
#include "src/core/input_error.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {

namespace {

/// True if supports or loads differ between load 0 and load 1.
bool depend_on_load(const Conditions& conditions, const LoadPath& loads) {
  if (conditions.obstacles().move()) return true;
  const auto values_at = [&](double load) {
    std::vector<double> values(conditions.prescribed().size()), force(values.size());
    conditions.prescribe(loads(load), values);
    conditions.external_force(loads(load), force);
    values.insert(values.end(), force.begin(), force.end());
    return values;
  };
  return values_at(0.0) != values_at(1.0);
}

}  // namespace

bool finds_loads(const StudyOptions& options, const Conditions& conditions) {
  return conditions.control() != nullptr || options.loading.mode == Mode::arc_length;
}

void refuse_unanswered_loads(const Body& body, const FreeDofs& free, Assembler& assembler,
                             LinearSolver& solver, TangentOperator& tangent) {
  const Conditions& conditions = *body.conditions;
  const DisplacementControl* const control = conditions.control();
  const LoadPath loads = [control](double load) {
    return control ? LoadPoint(0.0, load) : LoadPoint(load);
  };
  const std::vector<double> rest(conditions.prescribed().size(), 0.0);
  const EquilibriumProblem problem{assembler, conditions, free};
  std::vector<double> rate;
  const History history = assembler.initial_history();
  StateView at_rest(rest, history, Damage::grows, conditions.environment(loads(0.0)));
  if (assembler.has_contacts()) at_rest.foreseen = rest;  // those that touch press
  const LinearOutcome outcome = find_rate(problem, solver, tangent, at_rest, loads, 0.0, rate);
  if (outcome != LinearOutcome::solved) return;  // the search reports it
  if (norm(rate) == 0.0 && conditions.obstacles().move()) {
    throw InputError(
        "obstacles", "",
        "where the load is found, an obstacle that moves with load must touch the body "
        "from the start, unless something else moves the body");
  }
  if (norm(rate) == 0.0 && depend_on_load(conditions, loads)) {
    throw InputError(
        "supports", "",
        "where the load is found, supports and loads must start in proportion to load; these do "
        "not change with load at load = 0, like load^2 and abs(load). Give a multiple of load");
  }
  if (norm(rate) == 0.0) {
    throw InputError("supports", "",
                     "neither a support nor a load depends on load, so there is no path to follow");
  }
  if (control && !answer_of({control->weights(), 0.0, 0.0}, rate)) {
    throw InputError("controls", "",
                     "the controlled displacement does not respond to load: nothing that depends "
                     "on load moves it");
  }
}

}  // namespace peristat
