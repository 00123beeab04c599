#pragma once

#include <cstdint>
#include <vector>

#include "assembly/assembler.hpp"
#include "assembly/energy/state.hpp"
#include "solvers/drivers/fragment_pins.hpp"
#include "solvers/drivers/path_ledger.hpp"
#include "solvers/fracture/remaining_life.hpp"
#include "solvers/motion/stable_step.hpp"
#include "solvers/search/dynamic_relaxation.hpp"
#include "solvers/search/updated_tangent.hpp"

namespace peristat {

/// Everything that a path needs to go on from where a driver has left it. Bodies, conditions and
/// options are constant and not in it. Searches keep nothing from one step to the next, and draw no
/// random numbers. Solvers keep nothing either: every step factorises a tangent of its own before
/// it reuses one. A value: a copy goes on by itself.
struct PathState {
  State accepted;  ///< the last one: displacement, stage, histories
  int steps = 0;   ///< accepted after step 0
  PathLedger ledger;
  FragmentPins pins;
  /// Largest reaction of a support (2-norm), in the accepted state and so far [N].
  struct SupportForce {
    double present = 0.0, largest = 0.0;
    double top = 0.0;  ///< highest stage so far
  } force;
  bool stands_in = false;  ///< the stand-in (surrogate model) replaces the body
  struct Rungs {
    int body = 0, stand_in = 0;
  } rungs;                          ///< of ladders of solvers: see LinearSolver::rung
  double relaxation_seconds = 0.0;  ///< wall time in relaxation

  struct Implicit {
    double increment = 0.0;  ///< of the stage in the next step; 0: as in the first
  } implicit;
  struct Relaxed {
    double increment = 0.0;  ///< likewise
    RelaxationMotion motion;
  } relaxed;
  /// Under a control: sign of its response to the load at load 0, reversed if the number of
  /// negative pivots is odd there; 0: not known yet.
  int control_sign = 0;
  /// Controlled displacement in step 0, to which the programme's values are added [m].
  double control_at_load_zero = 0.0;
  struct Arc {
    double increment = 0.0;  ///< of the arc length in the next step; 0: as in the first
    /// Direction of the path in the accepted state, per unit of the arc length: of the displacement
    /// [m], and of the stage. Empty: not found yet.
    std::vector<double> direction;
    double stage_direction = 0.0;
    double displacement_scale = 0.0;     ///< norm of du/dstage at rest [m]
    std::int64_t negative_pivots = 0;    ///< in the accepted state
    bool passes_critical_point = false;  ///< in the next step; it has been located
  } arc;
  struct HandOver {
    bool relaxes = false;        ///< relaxation is in use
    bool is_near_onset = false;  ///< an implicit step was cut to end just before damage begins
    bool force_falls = false;    ///< it has fallen in the last relaxed step
    double peak_before = 0.0;    ///< stage at which the force has fallen; 0: no peak is searched
  } hand_over;
  /// State of mode path.
  struct Events {
    bool at_strength = false;    ///< bonds of the accepted state are at their resistance
    double top = 0.0;            ///< highest stage so far
    double longest = 0.0;        ///< largest change of the stage in a step; 0: no limit
    double largest_scale = 0.0;  ///< largest scale of a residual so far [N]
    double broke_at = 0.0;       ///< load factor of the last event
    /// Energy that bonds dissipate beyond what they stored, because they broke before their
    /// strength [J].
    double batch_work = 0.0;
    double released = 0.0;  ///< under the given control so far [J]
    /// In the last state under the given control [J]: stored and dissipated energy less the work of
    /// its dead loads and the batches' work, and the energy drained up to it.
    double response_energy = 0.0, response_drained = 0.0;
    std::int64_t count = 0;      ///< events so far
    TangentReference tangent{};  ///< tangent of the accepted state's search
  } events;
  /// State of mode dynamics; the stage is the time.
  struct Dynamics {
    bool has_begun = false;            ///< the initial state has been reported
    std::vector<double> velocity;      ///< per degree of freedom, in the accepted state [m/s]
    std::vector<double> acceleration;  ///< likewise, of implicit steps [m/s2]
    double step = 0.0;                 ///< time step in use [s]
    /// (dt^2/8) F.M^-1 F at the start, and what the steps have added to it [J].
    double correction_at_start = 0.0, correction = 0.0;
    double largest_energy = 0.0;           ///< largest energy put in so far [J]
    Stiffness stiffness;                   ///< with the eigenvalue found last
    double last_bound = 0.0;               ///< of the stiffness [1/s2]
    int look_interval = 0, next_look = 0;  ///< checks of the stiffness, in time steps
  } dynamics;
  /// State of mode fatigue, once the load has reached its largest value.
  struct Fatigue {
    double cycles = 0.0;  ///< so far
    int blocks = 0;       ///< of cycles, so far
    RemainingLives lives;
  } fatigue;
};

/// Returns a history without the entries of terms that follow others, which are recomputed from the
/// rest.
[[nodiscard]] History own_history(const History& history, const Assembler& body);

/// Returns a history with these entries recomputed.
[[nodiscard]] History with_followers(History history, const Assembler& body);

/// True if the sizes of its arrays are those of a body's; terms that follow others may be empty.
/// @param prescribed per degree of freedom
[[nodiscard]] bool is_of_body(const PathState& state, const Assembler& body,
                              const std::vector<char>& prescribed);

}  // namespace peristat
