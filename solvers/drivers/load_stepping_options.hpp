#pragma once

#include "solvers/drivers/fragment_pins.hpp"
#include "solvers/drivers/mode.hpp"
#include "solvers/search/dynamic_relaxation.hpp"

namespace peristat {

/// What mode arc_length does beside stepping.
struct ArcLengthOptions {
  /// Ends the path, unless the load has come to its end before; 0: only that ends it.
  int steps = 0;
  double largest_step = 1e6;  ///< to which steps may grow: in effect as far as the path is straight
  bool branches_off = true;   ///< at a bifurcation of a stable path to the path that leaves there
};

/// What mode path does.
struct EventOptions {
  /// Bonds within this share of the most utilised one break with it; 0: those alone that tie with
  /// it.
  double tolerance = 0.002;
};

/// How a body in motion is followed in time.
/// How a motion goes from one time step to the next.
enum class MotionScheme {
  verlet,   ///< explicit: VelocityVerlet
  newmark,  ///< implicit: Newmark
};

/// Where a motion begins.
enum class MotionStart {
  rest,         ///< undeformed, but for initial displacements
  equilibrium,  ///< in the equilibrium of supports and loads at t = 0
};

struct DynamicsOptions {
  double time_step = 0.0;   ///< [s]; 0: a share of the stable one
  double step_share = 0.9;  ///< of the stable step, which is found anew as the stiffness changes
  int steps_per_row = 100;  ///< time steps from one state that is told to the next
  MotionScheme scheme = MotionScheme::verlet;
  double spectral_radius = 1.0;  ///< of the implicit scheme at the highest frequencies, see Newmark
  MotionStart start = MotionStart::rest;

  /// Whether equilibria are searched, at the start or in each step.
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
  int relaxation_steps = 1;  ///< likewise in relaxation
  RelaxationOptions relaxation{};
  /// Relative residual of a relaxed step at which Newton's method takes its last iterations over,
  /// in adaptive mode.
  double newton_takes_over_at = 1e-5;
  /// Of the stage, in adaptive mode: a relaxed step in which the force begins to fall is halved
  /// until it is no longer than this. 0: never.
  double peak_tolerance = 0.0;
  /// Share of the largest force on a support so far below which the path has come to its end. 0:
  /// only the load ends it.
  double stop_below = 0.0;
  ArcLengthOptions arc_length{};
  EventOptions events{};
  DynamicsOptions dynamics{};
  FragmentRemedy fragments = FragmentRemedy::hold;
};

}  // namespace peristat
