#pragma once

#include <vector>

#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Supports and loads on the straight path from one load point to another.
class WayOfLoad {
 public:
  WayOfLoad(const EquilibriumProblem& problem, const State& from, const LoadPoint& to);

  [[nodiscard]] const std::vector<Index>& prescribed() const { return prescribed_; }
  /// Loaded degrees of freedom that follow others.
  [[nodiscard]] const std::vector<Index>& loaded_followers() const { return loaded_followers_; }
  [[nodiscard]] bool has_loads() const { return has_loads_; }
  [[nodiscard]] const std::vector<double>& end_displacement() const { return displacement1_; }
  [[nodiscard]] const std::vector<double>& end_force() const { return force1_; }

  [[nodiscard]] const SharedEnvironment& end_environment() const { return environment1_; }

  [[nodiscard]] SharedEnvironment environment(double share) const {
    return between(environment0_, environment1_, share);
  }
  [[nodiscard]] double displacement(Index dof, double share) const {
    return displacement0_[dof] + share * (displacement1_[dof] - displacement0_[dof]);
  }
  void load(double share, std::vector<double>& force) const {
    for (std::size_t dof = 0; dof < force.size(); ++dof) {
      force[dof] = force0_[dof] + share * (force1_[dof] - force0_[dof]);
    }
  }

 private:
  std::vector<double> displacement0_, displacement1_, force0_, force1_;
  SharedEnvironment environment0_, environment1_;
  std::vector<Index> prescribed_, loaded_followers_;
  bool has_loads_ = false;
};

}  // namespace peristat
