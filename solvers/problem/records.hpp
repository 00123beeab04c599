#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// One iteration of the equilibrium search (a row of iterations.csv). Iteration 0 is the state
/// right after the load step's jump of prescribed displacements and loads.
struct IterationRecord {
  int step = 0;
  int iteration = 0;
  double residual = 0.0;  ///< 2-norm over free degrees of freedom [N]
  double relative_residual = 0.0;
  double energy = 0.0;        ///< stored energy minus work of the present dead loads [J]
  double step_length = 0.0;   ///< of the line search
  int linear_iterations = 0;  ///< of the linear solver; 0 for a direct solve
  Index changed_bonds = 0;  ///< in transient relaxation: damaged since it began, counted each time
  double projection = 0.0;  ///< share by which the tangent's interactions were projected to their
                            ///< positive semidefinite part: 0 is the exact tangent
  /// Negative pivots of the exact tangent; 0 also where it was solved without a factorisation of
  /// its own, -1 where there are some but counting them was too expensive.
  std::int64_t negative_pivots = 0;
  int rejected_trials = 0;        ///< of the line search: the energy was too high
  int degenerate_trials = 0;      ///< of the line search: a measure had no gradient
  double linear_tolerance = 0.0;  ///< relative residual that the linear iterations were to reach; 0
                                  ///< for a direct solve
};

/// Stability of an accepted state under fixed loads; the values are those of history.csv.
enum class Stability : std::int8_t {
  bifurcated = -2,  ///< the tangent has negative pivots
  unstable = -1,    ///< failure goes on at the same load
  not_judged = 0,
  stable = 1,
};

/// Data of a body in motion.
struct MotionRecord {
  double time = 0.0;            ///< [s]
  double time_step = 0.0;       ///< present [s]
  double kinetic_energy = 0.0;  ///< of free degrees of freedom [J]
  /// Energy that the explicit scheme conserves where forces are linear: kinetic and stored energy
  /// less (dt^2/8) F.M^-1 F [J].
  double modified_energy = 0.0;
  Coordinates momentum{};  ///< likewise of free degrees of freedom [kg m/s]
};

/// One accepted step (a row of history.csv).
struct StepRecord {
  int step = 0;
  double stage = 0.0;  ///< of the loading programme
  double load_factor = 0.0;
  std::string mode;  ///< "newton", "relaxation", …
  int newton_iterations = 0;
  int relaxation_iterations = 0;
  double stored_energy = 0.0;      ///< [J]
  double dissipated_energy = 0.0;  ///< [J]
  double drained_energy = 0.0;     ///< [J]
  double external_work = 0.0;      ///< of supports and loads over the accepted steps, int P du [J]
  double numerical_work = 0.0;     ///< spent by relaxation beyond it [J]
  double balance_error = 0.0;  ///< external + numerical work - stored - dissipated - drained [J]
  Index broken_bonds = 0;
  double max_damage = 0.0;
  double max_stretch = 0.0;
  /// Implicit steps of bonds that fail by release: the largest utilisation of any before the step
  /// damaged them.
  double overload = 0.0;
  double pin_force = 0.0;  ///< on pinned fragments: 2-norm, 0 if nothing pulls [N]
  /// Norm of the sum of all internal forces [N]; 0 where these have a potential, and in motions.
  double unbalanced_force = 0.0;
  double control = 0.0;  ///< controlled displacement; 0 without a control [m]
  /// Negative pivots of the tangent by which a control or an arc length has found the state, or at
  /// it: 0 where the state is stable under fixed loads. -1: not counted.
  std::int64_t negative_pivots = -1;
  /// Mode path: true if the state is reached under the loads as they are given, without the rest of
  /// the path; and the energy released there since the start [J].
  bool is_on_response = true;
  double released_energy = 0.0;
  double strut_energy = 0.0;  ///< that struts stored when they were cut, also dissipated [J]
  Stability stability = Stability::not_judged;  ///< mode path judges it
  /// Mode path: load factor at which the last bonds broke; nothing: they broke in this step.
  std::optional<double> broke_at;
  double cycles = 0.0;                   ///< mode fatigue: of the load so far
  bool settled = false;                  ///< accepted without equilibrium: see RelaxationResult
  std::optional<MotionRecord> motion{};  ///< mode dynamics
  std::map<std::string, Coordinates> reactions;       ///< by support set [N]
  std::map<std::string, std::vector<double>> probes;  ///< by probe name: components, or one scalar
};

/// Decision of the load stepping about what comes next.
enum class Decision {
  accept,
  accept_and_grow,
  accept_at_round_off,
  cut,
  stop,
  hand_over,  ///< to relaxation
  hand_back,  ///< to Newton's method
  hold_fragments,
  remove_fragments,
  change_linear_solver,
  locate,  ///< a critical point between two states
  change_time_step,
  preload,     ///< step 0: loads at load factor 0 were applied
  branch_off,  ///< to the secondary path at a bifurcation
};

/// Name in decisions.csv.
[[nodiscard]] std::string name(Decision decision);
/// @throws std::out_of_range if there is none of this name
[[nodiscard]] Decision decision_named(const std::string& name);

/// One decision of the load stepping (a row of decisions.csv).
struct DecisionRecord {
  int step = 0;              ///< number that the step has, or would have had
  double stage = 0.0;        ///< that was attempted
  double load_factor = 0.0;  ///< there
  double increment = 0.0;    ///< of the stage that was attempted
  std::string outcome;       ///< name of the equilibrium search's outcome
  Decision action = Decision::accept;
  double next_increment = 0.0;
  std::string reason;
};

/// Histories of bonds: the largest stretch that has damaged a bond, -1 for a bond that never fails.
/// A bond that is not listed has the history that was written last, 0 if none was.
struct BondHistories {
  std::vector<Index> first_point, second_point;
  std::vector<double> largest_stretch;
  std::vector<Index> second_image{};  ///< as in BrokenBondRecord; empty for a body without images
};

/// A bond that has broken (a row of broken_bonds.csv).
struct BrokenBondRecord {
  int step = 0;
  double load_factor = 0.0;
  Index first_point = 0, second_point = 0;
  /// Kind of image of the second point that the bond ends at, numbered from 1; 0: the point itself.
  Index second_image = 0;
};

}  // namespace peristat
