#include "solvers/search/relaxation.hpp"

#include <algorithm>

namespace peristat {

double relaxation_scale(const EquilibriumProblem& problem, const Trial& start, const LoadPoint& to,
                        bool jumps) {
  std::vector<double> force(start.displacement.size());
  problem.conditions.external_force(to, force);
  const SharedEnvironment environment = problem.conditions.environment(to);
  Trial after_jump = start;
  if (jumps) {
    problem.conditions.prescribe(to, after_jump.displacement);
    share_out_jump(problem, start.displacement, after_jump.displacement);
    after_jump.environment = environment;
    // A jump that tears bonds would leave no residual to measure against.
    evaluate(problem, force, after_jump, Damage::held);
    if (after_jump.degenerate) after_jump.residual_norm = 0.0;  // a jump onto a neighbour
  }
  const double scale = residual_scale(problem, force, start.gradient, after_jump);
  if (!environment) return scale;
  Trial heated = start;
  heated.environment = environment;
  evaluate(problem, force, heated, Damage::held);
  return std::max(scale, environment_norm(problem, heated.at(Damage::held), heated.gradient));
}

double taken_up(const EquilibriumProblem& problem, Breaking breaking, const Trial& at) {
  if (breaking == Breaking::at_equilibrium) return at.stored_energy;
  std::vector<double> damage(std::size_t(problem.assembler.points().count()));
  return at.stored_energy + problem.assembler.assess(at.history, {}, damage).dissipated_energy;
}

}  // namespace peristat
