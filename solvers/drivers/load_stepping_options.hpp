#pragma once

#include "solvers/drivers/fragment_pins.hpp"
#include "solvers/drivers/mode.hpp"
#include "solvers/fracture/remaining_life.hpp"
#include "solvers/search/dynamic_relaxation.hpp"

namespace peristat {

/// Options of mode arc_length beside those of its steps.
struct ArcLengthOptions {
  /// Number of steps after which the path ends, unless the load ends before; 0: only the load ends
  /// it.
  int steps = 0;
  double largest_step = 1e6;  ///< limit of their growth: in effect as far as the path is straight
  bool branches_off = true;   ///< at a bifurcation of a stable path, to the path that leaves there
};

/// Options of mode path.
struct EventOptions {
  /// Bonds within this fraction of the most utilised one break with it; 0: only those that tie with
  /// it.
  double tolerance = 0.002;
};

/// Time integration scheme of a motion.
enum class MotionScheme {
  verlet,   ///< explicit: VelocityVerlet
  newmark,  ///< implicit: Newmark
};

/// Where a motion begins.
enum class MotionStart {
  rest,         ///< undeformed, except for initial displacements
  equilibrium,  ///< in the equilibrium of supports and loads at t = 0
};

struct DynamicsOptions {
  double time_step = 0.0;   ///< [s]; 0: `step_share` of the stable one
  double step_share = 0.9;  ///< of the stable step, which is recomputed as the stiffness changes
  int steps_per_row = 100;  ///< time steps between two reported states
  MotionScheme scheme = MotionScheme::verlet;
  double spectral_radius = 1.0;  ///< of the implicit scheme at the highest frequencies, see Newmark
  MotionStart start = MotionStart::rest;

  /// True if equilibria are searched, at the start or in each step.
  [[nodiscard]] bool searches() const {
    return scheme == MotionScheme::newmark || start == MotionStart::equilibrium;
  }
};

struct LoadSteppingOptions {
  Mode mode = Mode::newton;
  int steps = 1;         ///< equal steps from one entry of the programme to the next
  bool adaptive = true;  ///< cut after a failure and grow again; otherwise a failure ends the run
  double smallest_step = 1e-6;  ///< of the stage; a cut below it ends the run
  double largest_step = 0.0;    ///< of the stage; 0 means 1 / steps
  double cut = 0.5;             ///< factor of the step after a failure
  double growth = 2.0;          ///< factor of the step after an easy success, up to largest_step
  int easy_iterations = 5;      ///< a step with no more iterations than this was easy
  /// Bonds that may break in one implicit step; a step with more is cut. 0: no limit.
  int max_broken_bonds = 0;
  int relaxation_steps = 1;  ///< equal relaxed steps from one entry to the next
  RelaxationOptions relaxation{};
  /// Relative residual of a relaxed step at which Newton's method takes over its last iterations,
  /// in adaptive mode.
  double newton_takes_over_at = 1e-5;
  /// Adaptive mode: a relaxed step in which the force begins to fall is halved until it is no
  /// longer than this, in the stage. 0: never.
  double peak_tolerance = 0.0;
  /// The path ends once the largest force on a support falls below this fraction of its largest
  /// value so far. 0: only the load ends it.
  double stop_below = 0.0;
  ArcLengthOptions arc_length{};
  EventOptions events{};
  DynamicsOptions dynamics{};
  FatigueOptions fatigue{};
  FragmentRemedy fragments = FragmentRemedy::hold;
};

}  // namespace peristat
