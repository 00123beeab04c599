#include "solvers/search/way_of_load.hpp"

namespace peristat {

WayOfLoad::WayOfLoad(const EquilibriumProblem& problem, const State& from, const LoadPoint& to)
    : displacement0_(from.displacement),
      displacement1_(from.displacement),
      force0_(from.displacement.size()),
      force1_(from.displacement.size()) {
  problem.conditions.prescribe(to, displacement1_);
  problem.conditions.external_force(load_point(from), force0_);
  problem.conditions.external_force(to, force1_);
  const std::vector<char>& dependent = problem.conditions.constraints().dependent();
  environment0_ = from.environment;
  environment1_ = problem.conditions.environment(to);
  for (std::size_t dof = 0; dof < displacement0_.size(); ++dof) {
    const bool is_free = problem.free.equation[dof] != FreeDofs::none;
    if (!is_free && !dependent[dof]) prescribed_.push_back(Index(dof));
    const bool is_loaded = force0_[dof] != 0.0 || force1_[dof] != 0.0;
    has_loads_ |= is_loaded;
    if (is_loaded && dependent[dof]) loaded_followers_.push_back(Index(dof));
  }
  has_loads_ = problem.sums().largest_of_all(double(has_loads_)) > 0.0;
}

}  // namespace peristat
