#include "solvers/problem/working_force.hpp"

namespace peristat {

std::vector<double> working_force(const Conditions& conditions, const Trial& state,
                                  std::span<const double> external_force) {
  const std::vector<char>&prescribed = conditions.prescribed(),
        &dependent = conditions.constraints().dependent();
  std::vector<double> force(external_force.begin(), external_force.end());
  for (std::size_t dof = 0; dof < force.size(); ++dof) {
    if (prescribed[dof] && !dependent[dof]) force[dof] = state.gradient[dof];
    if (!state.follower_force.empty()) force[dof] += state.follower_force[dof];
  }
  return force;
}

double trapezoidal_work(const Sums& sums, std::span<const double> force0,
                        std::span<const double> force1, std::span<const double> u0,
                        std::span<const double> u1) {
  double work = 0.0;
  sums.for_each_entry(
      u0.size(), [&](std::size_t k) { work += 0.5 * (force0[k] + force1[k]) * (u1[k] - u0[k]); });
  return sums.of_all(work);
}

}  // namespace peristat
