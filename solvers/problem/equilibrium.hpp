#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "assembly/assembler.hpp"
#include "assembly/operators/tangent_operator.hpp"
#include "solvers/linear/free_dofs.hpp"
#include "src/conditions/conditions.hpp"
#include "src/parallel/sums.hpp"

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
  fragmented,           ///< a fragment has come off, and the run is to end with that
  undefined_condition,  ///< supports or loads have no value, or two, at the stage
  no_answer,            ///< the controlled displacement does not respond to the load
  sharp_turn,           ///< the path turns by too much for the step
  step_limit,           ///< the largest number of steps is reached before the final load
  damage_begins,        ///< bonds would be damaged although integrities are held
  inconsistent,         ///< a found state violates a balance (solvers/problem/consistency.hpp)
  unstable_step,        ///< the explicit scheme's step is longer than the stable one
  interrupted,          ///< by the user
};

[[nodiscard]] std::string name(Outcome outcome);
[[nodiscard]] std::string explanation(Outcome outcome);

/// The equilibrium problem f_ext(stage) - dE/dx(u) = 0 on the free degrees of freedom, with all
/// that is constant in a solve. The total energy E(u) - f_ext.u is the merit function.
struct EquilibriumProblem {
  Assembler& assembler;
  const Conditions& conditions;
  const FreeDofs& free;
  const InertialSprings* inertia = nullptr;  ///< in a step of an implicit motion

  /// Sums over the whole body.
  [[nodiscard]] Sums sums() const { return {assembler.index_map(), assembler.points().dimension}; }

  /// Loading data that the energy depends on, at a load point and with `inertia`.
  [[nodiscard]] SharedEnvironment environment(const LoadPoint& at) const;
};

/// A trial state with all data that decisions about it need.
struct Trial {
  std::vector<double> displacement;  ///< [m]
  History history;                   ///< of the committed states before it
  SharedEnvironment environment;     ///< of the load point
  /// dE/dx [N] less the follower force; forces on dependent degrees of freedom are folded onto
  /// masters.
  std::vector<double> gradient;
  std::vector<Tensor> curvature{};     ///< of rigid sets, see Constraints
  std::vector<double> follower_force;  ///< of pressures [N]; empty: none
  double stored_energy = 0.0;          ///< [J]
  double energy_round_off = 0.0;       ///< of that, see Evaluation [J]
  double total_energy = 0.0;           ///< stored energy - f_ext.u + Obstacles::potential [J]
  double residual_norm = 0.0;          ///< 2-norm of f_ext - dE/dx over free degrees of freedom [N]
  bool degenerate = false;
  std::span<const double> foreseen{};  ///< see StateView

  [[nodiscard]] StateView at(Damage damage = Damage::grows) const {
    StateView view(displacement, history, damage, environment);
    view.curvature = curvature;
    view.foreseen = foreseen;
    return view;
  }
};

/// Load point of a state.
[[nodiscard]] inline LoadPoint load_point(const State& state) {
  LoadPoint at(state.stage, state.load);
  at.preload = state.preload;
  return at;
}

/// Adjusts a displacement that contains a jump of the prescribed ones to the state right after it,
/// see Constraints::share_out_jump.
/// @param from before the jump
void share_out_jump(const EquilibriumProblem& problem, std::span<const double> from,
                    std::span<double> displacement);
/// Moves dependent degrees of freedom to where their masters take them, and ghosts to where their
/// owners are.
void move_followers(const EquilibriumProblem& problem, std::span<double> displacement);
inline void move_followers(const EquilibriumProblem& problem, Trial& trial) {
  move_followers(problem, trial.displacement);
}
/// Folds the assembler's gradient onto masters, and finds the curvature of rigid sets.
void fold_followers(const EquilibriumProblem& problem, std::span<const double> external_force,
                    Trial& trial);

/// Largest share of a step, from 0 to 1, that no contact passes its largest depth within.
/// @param step of the independent degrees of freedom; followers take part
[[nodiscard]] double allowed_share(const EquilibriumProblem& problem, const StateView& at,
                                   std::span<const double> step);

/// Adds to each degree of freedom the stiffness of contacts, see TermPasses; of jumps over periods,
/// too [N/m].
void add_contact_stiffness(const EquilibriumProblem& problem, const StateView& at,
                           double most_depth, std::span<double> stiffness);

/// Work of heating on the way between two states [J], by the trapezoidal rule: the mean of the
/// energies that the change of the environment would add to either state, with damage held. For
/// obstacles, within which a contact's energy means nothing, the mean of their forces.
[[nodiscard]] double heating_work(Assembler& assembler, const StateView& from, const StateView& to);

/// Norm of what the environment and contacts contribute to the forces of a state [N]: a scale for
/// residuals, since a body that expands freely, or between obstacles, has no other forces.
/// @param gradient there
[[nodiscard]] double environment_norm(const EquilibriumProblem& problem, const StateView& at,
                                      std::span<const double> gradient);

/// Moves dependent degrees of freedom, and evaluates energy and gradient at the trial's
/// displacement after its history.
void evaluate(const EquilibriumProblem& problem, std::span<const double> external_force,
              Trial& trial, Damage damage = Damage::grows);

/// Norm that the residual of a step is measured against [N]: the largest of ||f_ext||, of the
/// reactions in the old state, and of the residual right after the step's jump of supports and
/// loads.
[[nodiscard]] double residual_scale(const EquilibriumProblem& problem,
                                    std::span<const double> external_force,
                                    std::span<const double> old_gradient, const Trial& after_jump);

/// Largest of the norms of loads, of reactions, and of the environment's contribution to the
/// forces: a scale for residuals [N].
[[nodiscard]] double load_norm(const EquilibriumProblem& problem,
                               std::span<const double> external_force, const Trial& state,
                               Damage damage);

/// 2-norm of the terms whose differences are the forces by convolutions: each point's stiffness
/// times its displacement from the mean [N]. Their round-off spreads to all points.
[[nodiscard]] double differenced_forces(const TangentOperator& tangent,
                                        std::span<const double> displacement);

/// Residual that round-off leaves [N]. A displacement is known to a unit round-off of itself, so
/// that a slender body, which moves far and strains little, has no state with a residual below
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
