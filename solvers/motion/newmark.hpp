#pragma once

#include <functional>
#include <vector>

#include "solvers/linear/linear_solver.hpp"
#include "solvers/motion/motion.hpp"
#include "solvers/search/newton.hpp"

namespace peristat {

/// Coefficients of the generalised alpha method with spectral radius rho at the highest frequencies
/// [Chung and Hulbert 1993, eqs. 17, 25]:
///
///   alpha_m = (2 rho - 1) / (rho + 1),   alpha_f = rho / (rho + 1),
///   gamma = 1/2 - alpha_m + alpha_f,     beta = (1 - alpha_m + alpha_f)^2 / 4
struct NewmarkCoefficients {
  explicit NewmarkCoefficients(double spectral_radius);
  double of_inertia, of_force, gamma, beta;

  /// k / M of a step, see Newmark [1/s2].
  [[nodiscard]] double stiffness_per_mass(double dt) const {
    return (1.0 - of_inertia) / ((1.0 - of_force) * beta * dt * dt);
  }
};

/// Implicit steps by Newmark's method in the form of the generalised alpha method
/// [Chung and Hulbert 1993]:
///
///   u^(n+1) = u^n + dt v^n + dt^2 ((1/2 - beta) a^n + beta a^(n+1)),
///   v^(n+1) = v^n + dt ((1 - gamma) a^n + gamma a^(n+1)),
///   (1 - alpha_m) M a^(n+1) + alpha_m M a^n = (1 - alpha_f) F^(n+1) + alpha_f F^n
///
/// Spectral radius 1 is Newmark's method of average acceleration, beta = 1/4, gamma = 1/2, since
/// M a^0 = F^0: where forces are linear it keeps kinetic and stored energy at any step. Below 1
/// frequencies that a step does not resolve are damped, the highest ones by that factor a step.
///
/// A step is a search for equilibrium in which springs replace the inertia, of stiffness
/// k = (1 - alpha_m) / ((1 - alpha_f) beta dt^2) M, from where inertia alone would take the points:
///
///   F(u) = k (u - p) + c,   p = u^n + dt v^n + dt^2 (1/2 - beta) a^n,
///   c = (alpha_m M a^n - alpha_f F^n) / (1 - alpha_f)
///
/// With a drag (Drag), dt v^n becomes phi1 dt v^n and decay v^n, 1/2 and beta become phi2 and
/// 2 beta phi2, 1 and gamma become phi1 and gamma phi1: exact under a constant force. With the mean
/// acceleration a of the step the drag absorbs, by the integral of eta M v.v over it,
///
///   M ((1 - decay^2)/2 v.v + phi1 (1 - decay) dt v.a + (phi2 - phi1^2/2) dt^2 a.a)
///
/// With spectral radius 1 that is exactly the trapezoidal work of F less the change of v.Mv/2, so
/// that the method stays stable at any step.
///
/// Damage grows in the search. If the search fails, it is repeated with integrities held. Bonds
/// that are stretched too far in the result are damaged, and the search starts again, until none
/// is.
class Newmark : public Motion {
 public:
  struct Search {
    LinearSolver& solver;
    TangentOperator& tangent;
    NewtonOptions options;
    std::function<bool()> interrupted;  ///< may be empty
  };

  /// @param acceleration of the state; empty: M^-1 F
  Newmark(const EquilibriumProblem& problem, const MotionSetting& setting, const State& from,
          std::vector<double> velocity, std::vector<double> acceleration, double spectral_radius,
          Search search);

  [[nodiscard]] Outcome step(double dt, double time) override;
  [[nodiscard]] std::vector<double> take_acceleration() override {
    return std::move(acceleration_);
  }

 private:
  [[nodiscard]] InertialSprings inertia_of_step(double dt) const;
  /// Searches equilibria at the end of a step, until nothing more is damaged.
  /// @return the last one; its history is committed
  [[nodiscard]] NewtonResult find(double time, const InertialSprings& inertia);
  void accelerate(double dt, const std::vector<double>& force_before);

  NewmarkCoefficients coefficients_;
  std::vector<double> acceleration_;  // 0 where it is prescribed
  Search search_;
};

}  // namespace peristat
