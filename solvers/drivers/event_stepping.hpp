#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assembly/borne_stretches.hpp"
#include "solvers/drivers/driver.hpp"
#include "solvers/drivers/found_step.hpp"
#include "solvers/search/strength_search.hpp"

namespace peristat {

/// Sequentially linear analysis: goes from one event to the next, that is, from a state in which
/// the most utilised bonds are at their strength to the one in which the next ones are. Between two
/// events integrities are fixed and the body is elastic; nothing depends on steps of the load, on
/// inertia or on damping.
///
/// An event removes the resistance of its bonds (all of it, or a tooth of a saw-tooth) at the state
/// and the load at which it happens, and the body settles there. The next strength is then met at a
/// higher load, or at a lower one, where the path snaps back. If there is none within the present
/// segment of the programme, the load is held, and overloaded bonds break until there is none: an
/// avalanche.
///
/// Bonds whose utilisations agree within `tie` belong to one event, so that symmetric bodies stay
/// symmetric. Bonds within the tolerance of the most utilised one break with it. A batch ends at a
/// gap wider than a tie, never between two bonds that round-off might exchange.
///
/// The response under the given loads leaves the path where it snaps back, and joins it where the
/// path returns to the highest load so far: the path has a state there, too.
///
/// Energies: an event takes from the bonds exactly what their law dissipates (batches: less,
/// reported as numerical work). Energy that settling frees is drained. Between two events the work
/// is what the elastic body takes up; the trapezoidal rule's error is reported as numerical work.
///
/// Contacts are part of the elastic body. A search ends where one closes or opens: such a state is
/// a step of the path.
class EventStepping : public Driver {
 public:
  /// @throws InputError ("mode") for a body without damage, or with laws that fall smoothly
  explicit EventStepping(Path& path);

  /// Utilisations nearer than this are equal: a hundred times the error that equilibrium to 1e-10
  /// leaves in them in a well-conditioned body.
  static constexpr double tie = 1e-7;

 protected:
  [[nodiscard]] Advance next() override;

 private:
  /// The body after an event, settled at the load of the event.
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

  /// A step in progress.
  struct Step {
    Attempt attempt;
    FoundStep found;
    StrengthEnd end = StrengthEnd::inadmissible;
    std::optional<std::vector<UtilisedBond>> utilised;  ///< see utilised_near
    std::string fault;
    double attempted = 0.0;
    std::string how;
  };

  /// Carries out the next event: bonds drop at a state, and the body settles.
  /// @param utilised see utilised_near
  [[nodiscard]] Settled settle(const State& at, const PathLedger& ledger,
                               std::vector<UtilisedBond> utilised);
  /// True if contacts press or touch.
  [[nodiscard]] bool touches(const State& at) const;
  /// Searches the equilibrium at the present load, if it is not far.
  [[nodiscard]] Attempt settle_nearby(const State& at, std::span<const double> borne,
                                      double relative_tolerance);
  /// Searches a stable one, by lines of descending energy along projected tangents.
  [[nodiscard]] Attempt settle_downhill(const State& at, double relative_tolerance);
  /// True if the tangent at an equilibrium has negative pivots; checked if it had some on the way.
  [[nodiscard]] bool is_unstable(const Attempt& attempt);
  /// Settles nearby or, if that fails or contacts touch, downhill.
  [[nodiscard]] Attempt settle_anywhere(const State& at, std::span<const double> borne,
                                        double relative_tolerance);
  /// Closes the ledger of an event.
  /// @param lost energy that the body loses as the bonds drop [J]
  /// @return false if it would come to rest with more energy than it had
  [[nodiscard]] bool book_event(const State& at, const PathLedger& ledger, const BondDrops& dropped,
                                double lost, Settled& settled) const;
  [[nodiscard]] bool asks_for_interrupt() const;
  /// Utilisation of the bonds that may drop in an event, and of those beyond the gap that ends it.
  [[nodiscard]] double least_utilisation() const;
  /// These bonds of a state at its strength, most utilised first.
  [[nodiscard]] std::vector<UtilisedBond> utilised_near(const State& at) const;
  /// Those of them that drop together in the next event.
  [[nodiscard]] std::vector<UtilisedBond> batch_of(std::vector<UtilisedBond> utilised) const;
  /// Makes a settled state the accepted one.
  void take_up(Settled settled);
  /// Pins fragments that have come off, which changes the equations.
  [[nodiscard]] bool pin(Settled& settled);

  [[nodiscard]] Step search();
  /// Holds the load until no bond is overloaded.
  [[nodiscard]] Step run_avalanche();
  /// True if a step has ended with overloaded bonds, on the way to a lower load.
  [[nodiscard]] bool is_above_strength(const Step& step) const;
  /// Goes on from such a state, which is not reported as accepted.
  void pass_over(Step& step);
  /// Closes the step's ledger.
  void complete(Step& step);
  /// Books the trapezoidal rule's error as numerical work, or refuses the step if it is too large.
  void settle_work(Step& step) const;
  /// Largest error of the work of contacts that the step itself explains: forces that do work go
  /// from their old values to the new ones [J]. More means that the body has jumped.
  [[nodiscard]] double explained_work(const Step& step) const;
  /// @param before the path as it was before the step
  [[nodiscard]] Advance accept(Step step, PathState before);
  /// Records where the state is on the response under the given loads.
  void tell_response(const Step& step, StepRecord& record);
  [[nodiscard]] Stability stability_of_elastic_body();
  [[nodiscard]] Advance fail(Step step, PathState before);
  [[nodiscard]] StrengthStep strength_step() const;
  [[nodiscard]] double utilisation(const State& at, std::span<const double> borne) const;
  /// Tangent of the present equations.
  [[nodiscard]] UpdatedTangent& tangent();
  [[nodiscard]] NewtonOptions held() const;

  // All of these can be recomputed from the path's state.
  std::optional<Settled> ahead_;  // next event of the accepted state
  std::vector<double> borne_;     // resistances in the accepted state; empty: not known
  std::unique_ptr<UpdatedTangent> tangent_;
  bool tells_ = true;
};

}  // namespace peristat
