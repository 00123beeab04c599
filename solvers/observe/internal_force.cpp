#include "solvers/observe/internal_force.hpp"

namespace peristat {

std::vector<double> internal_force(const Body& body, const Trial& state,
                                   std::span<const double> external_force) {
  std::vector<double> force = state.gradient;
  const Constraints& constraints = body.conditions->constraints();
  constraints.unfold(external_force, force);
  for (double& component : force) component = -component;
  std::vector<double> follower_force = state.follower_force;
  if (!follower_force.empty()) constraints.fold_images(follower_force);
  for (std::size_t k = 0; k < follower_force.size(); ++k) force[k] -= follower_force[k];
  body.conditions->foundations().add_force(state.displacement, state.environment, -1.0, force);
  body.conditions->obstacles().add_force(state.displacement, state.environment,
                                         state.history.slips(), -1.0, force);
  return force;
}

}  // namespace peristat
