#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assembly/terms/bonds/borne_stretches.hpp"
#include "solvers/drivers/driver.hpp"
#include "solvers/drivers/found_step.hpp"
#include "solvers/search/strength_search.hpp"

namespace peristat {

/// Goes from one event to the next: from a state in which the most utilised bonds are at their
/// strength to the one in which the next ones are. Between two events integrities are fixed and the
/// body is elastic; nothing depends on steps of the load, on inertia or on damping.
///
/// An event takes from its bonds what they bear (all of it, or a tooth of a saw-tooth), at the
/// state and the load that it happens in, and the body settles there. The next strength is then met
/// at a higher load, or at a lower one, where the path snaps back. Where there is none within the
/// present segment of the programme, the load is held, and what is above its strength breaks until
/// nothing is: an avalanche.
///
/// Bonds whose utilisations agree within `tie` belong to one event, so that symmetric bodies stay
/// symmetric. Those within the tolerance of the most utilised one break with it; a batch ends at a
/// gap wider than a tie, never between two that round-off might exchange.
///
/// Under the given loads the path is left where it snaps back, and joined where it comes back to
/// the load: that state is one of the path's too.
///
/// Energies: an event takes from the bonds exactly what their law dissipates (batches: less, told
/// as numerical work). What settling frees is drained. Between two events the work is what the
/// elastic body takes up; the trapezoidal rule's error is told as numerical work.
class EventStepping : public Driver {
 public:
  /// @throws InputError ("mode") for a body without damage, or whose laws fall smoothly
  explicit EventStepping(Path& path);

  /// Utilisations nearer than this are the same: a hundred times what equilibrium to 1e-10 leaves
  /// of them in a well-conditioned body.
  static constexpr double tie = 1e-7;

 protected:
  [[nodiscard]] Advance next() override;

 private:
  /// The body after an event, settled at the load that it has happened at.
  struct Settled {
    Outcome outcome = Outcome::converged;
    std::string fault;
    Attempt attempt;
    State state;
    PathLedger ledger;
    FragmentPins pins;
    std::vector<double> borne;  ///< see borne_stretches
    double utilisation = 0.0;   ///< the largest
    double batch_work = 0.0;    ///< see PathState::Events
    Index breaking = 0, dropping = 0;

    [[nodiscard]] bool has_converged() const { return outcome == Outcome::converged; }
  };

  /// A step on its way.
  struct Step {
    Attempt attempt;
    FoundStep found;
    StrengthEnd end = StrengthEnd::inadmissible;
    std::string fault;
    double attempted = 0.0;
    std::string how;
  };

  /// The next event: what drops at a state, and where that settles.
  [[nodiscard]] Settled settle(const State& at, const PathLedger& ledger);
  /// Equilibrium at the load where it is, if it is not far.
  [[nodiscard]] Attempt settle_nearby(const State& at, std::span<const double> borne,
                                      double relative_tolerance);
  /// Likewise, a stable one, by lines of descending energy along projected tangents.
  [[nodiscard]] Attempt settle_downhill(const State& at, double relative_tolerance);
  /// Whether the tangent at an equilibrium has negative pivots, where it had some on the way.
  [[nodiscard]] bool is_unstable(const Attempt& attempt);
  /// The one, or else the other.
  [[nodiscard]] Attempt settle_anywhere(const State& at, std::span<const double> borne,
                                        double relative_tolerance);
  /// Closes the ledger of an event.
  /// @param lost energy that the body has lost as the bonds dropped [J]
  /// @return false if it would have come to rest with more energy than it had
  [[nodiscard]] bool book_event(const State& at, const PathLedger& ledger, const BondDrops& dropped,
                                double lost, Settled& settled) const;
  [[nodiscard]] bool asks_for_interrupt() const;
  /// Bonds that drop together.
  [[nodiscard]] std::vector<UtilisedBond> batch_of(const State& at) const;
  /// Makes what has settled the state to go on from.
  void take_up(Settled settled);
  /// Pins what has come off, in the equations.
  [[nodiscard]] bool pin(Settled& settled);

  [[nodiscard]] Step search();
  /// Holds the load until nothing is above its strength.
  [[nodiscard]] Step run_avalanche();
  /// Whether a step has ended where bonds are above their strength, on the way to a lower load.
  [[nodiscard]] bool is_above_strength(const Step& step) const;
  /// Goes on from there: no state to be accepted.
  void pass_over(Step& step);
  /// Closes the step's ledger.
  void complete(Step& step);
  /// Books the trapezoidal rule's error, or refuses the step for it.
  void settle_work(Step& step) const;
  /// @param before the path as it was before the step
  [[nodiscard]] Advance accept(Step step, PathState before);
  /// Tells where the state is on the response under the given loads.
  void tell_response(const Step& step, StepRecord& record);
  [[nodiscard]] Stability stability_of_elastic_body();
  [[nodiscard]] Advance fail(Step step, PathState before);
  [[nodiscard]] StrengthStep strength_step() const;
  [[nodiscard]] double utilisation(const State& at, std::span<const double> borne) const;
  /// The tangent of the present equations.
  [[nodiscard]] UpdatedTangent& tangent();
  [[nodiscard]] NewtonOptions held() const;

  // None of these is more than what can be found anew from the path's state.
  std::optional<Settled> ahead_;  // of the accepted state
  std::vector<double> borne_;     // after the history of the accepted state; empty: not known
  std::unique_ptr<UpdatedTangent> tangent_;
  bool tells_ = true;
};

}  // namespace peristat
