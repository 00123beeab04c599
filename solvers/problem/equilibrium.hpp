#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "assembly/assembler.hpp"
#include "assembly/operators/tangent_operator.hpp"
#include "solvers/linear/free_dofs.hpp"
#include "solvers/linear/sums.hpp"
#include "src/conditions/conditions.hpp"

namespace peristat {

/// How a search for equilibrium ended. Reaching a limit is never success.
enum class Outcome {
  converged,
  iteration_limit,        ///< residual still above the tolerance
  not_positive_definite,  ///< the tangent has negative pivots: a limit point, buckling or softening
  singular_tangent,       ///< a motion without stiffness: too few bonds or supports
  no_descent,             ///< the Newton direction does not lower the energy
  line_search_failed,     ///< no step length lowers the energy
  degenerate,             ///< an interaction has collapsed to zero, or values are not finite
  out_of_memory,          ///< of the linear solver
  linear_solver_inaccurate,
  limit_point,          ///< damage makes the body unstable: no equilibrium near at a higher load
  damage_limit,         ///< more bonds break at once than allowed, however small the step
  fragmented,           ///< a piece has come off, and that is to end the run
  undefined_condition,  ///< supports or loads have no value, or two, at the stage
  no_answer,            ///< the controlled displacement does not answer to the load
  sharp_turn,           ///< the path turns by too much for the step
  step_limit,           ///< as many steps as allowed, and the load has not come to its end
  damage_begins,        ///< where the integrities are to stay as they are
  inconsistent,         ///< a state found breaks a balance that it owes (solvers/consistency.hpp)
  unstable_step,        ///< the explicit scheme's step is longer than the stable one
  interrupted,          ///< by the person
};

[[nodiscard]] std::string name(Outcome outcome);
[[nodiscard]] std::string explanation(Outcome outcome);

/// The equilibrium problem f_ext(stage) - dE/dx(u) = 0 on the free degrees of freedom, with
/// what is constant in a solve. The total energy E(u) - f_ext.u is the merit function.
struct EquilibriumProblem {
  Assembler& assembler;
  const Conditions& conditions;
  const FreeDofs& free;
  const InertialSprings* inertia = nullptr;  ///< in a step of an implicit motion

  /// Over the whole body.
  [[nodiscard]] Sums sums() const { return {assembler.sharing(), assembler.points().dimension}; }

  /// What the energy depends on at a load point.
  [[nodiscard]] SharedEnvironment environment(const LoadPoint& at) const;
};

/// A trial state with everything that a decision about it needs.
struct Trial {
  std::vector<double> displacement;  ///< [m]
  History history;                   ///< that it comes after
  SharedEnvironment environment;     ///< that of the load point
  /// dE/dx [N] less the follower force, with what acts on followers folded onto what they follow.
  std::vector<double> gradient;
  std::vector<Tensor> curvature{};     ///< of rigid sets, see Constraints
  std::vector<double> follower_force;  ///< of pressures [N]; empty: none
  double stored_energy = 0.0;          ///< [J]
  double energy_round_off = 0.0;       ///< of that, see Evaluation [J]
  double total_energy = 0.0;           ///< stored energy - f_ext.u [J]
  double residual_norm = 0.0;          ///< 2-norm of f_ext - dE/dx over free degrees of freedom [N]
  bool degenerate = false;

  [[nodiscard]] StateView at(Damage damage = Damage::grows) const {
    StateView view(displacement, history, damage, environment);
    view.curvature = curvature;
    return view;
  }
};

/// Where its supports and loads are.
[[nodiscard]] inline LoadPoint load_point(const State& state) {
  LoadPoint at(state.stage, state.load);
  at.preload = state.preload;
  return at;
}

/// Takes a displacement to the state right after a jump of the prescribed ones, which are in it
/// already.
/// @param from before the jump
void share_out_jump(const EquilibriumProblem& problem, std::span<const double> from,
                    std::span<double> displacement);
/// Moves what follows other degrees of freedom to where these have taken it, and ghosts to where
/// their owners are.
void move_followers(const EquilibriumProblem& problem, Trial& trial);
/// Folds the gradient that the assembler has found onto what is followed.
void fold_followers(const EquilibriumProblem& problem, std::span<const double> external_force,
                    Trial& trial);

/// Work that heating does on the way between two states [J], by the trapezoidal rule: half of what
/// it would add to the energy in the one and in the other, with the damage that is there.
[[nodiscard]] double heating_work(Assembler& assembler, const StateView& from, const StateView& to);

/// Norm of what the environment adds to the forces of a state [N]: a scale for residuals, since
/// where nothing holds a body that grows no other force is left.
/// @param gradient there
[[nodiscard]] double environment_norm(const EquilibriumProblem& problem, const StateView& at,
                                      std::span<const double> gradient);

/// Moves what follows to the trial's displacement, and evaluates energy and gradient there after
/// its history.
void evaluate(const EquilibriumProblem& problem, std::span<const double> external_force,
              Trial& trial, Damage damage = Damage::grows);

/// Norm that the residual of a step is measured against [N]: the largest of ||f_ext||, of the
/// reactions in the old state, and of the residual right after the step's jump of supports and
/// loads.
[[nodiscard]] double residual_scale(const EquilibriumProblem& problem,
                                    std::span<const double> external_force,
                                    std::span<const double> old_gradient, const Trial& after_jump);

/// The larger of loads and reactions of a state, and of what its environment adds to its forces: a
/// scale for residuals [N].
[[nodiscard]] double load_norm(const EquilibriumProblem& problem,
                               std::span<const double> external_force, const Trial& state,
                               Damage damage);

/// What forces by convolutions are differences of: each point's stiffness times how far it moves,
/// their 2-norm [N]. Round-off of them spreads to all points.
[[nodiscard]] double differenced_forces(const TangentOperator& tangent,
                                        std::span<const double> displacement);

/// What round-off leaves of the residual [N]. A displacement is known to a unit round-off of
/// itself, so that a slender body, which moves far and strains little, has no state with less than
/// about
///
///   ||eps sum_j |K_ij| max |u_i| ||
///
/// over its free degrees of freedom, u_i the displacement of the point; by convolutions
/// eps `differenced_forces` in addition.
/// @param tangent near the state
[[nodiscard]] double residual_round_off(const Sums& sums, const FreeDofs& free,
                                        const TangentOperator& tangent,
                                        std::span<const double> displacement);

}  // namespace peristat
