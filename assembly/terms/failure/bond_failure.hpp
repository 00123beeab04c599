#pragma once

#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "assembly/terms/failure/damage_drive.hpp"
#include "assembly/terms/failure/failure_model.hpp"
#include "assembly/terms/failure/strength_onsets.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Bonds that fail by their stretch, if their potential is one of damage, or by an equivalent one.
///
/// The history is the largest (equivalent) stretch of each bond over the committed states, as far
/// as it has damaged the bond: 0 before, Degraded::never_fails where that is said.
///
/// By release a bond is driven by what the energy Pi of all terms would lose with it. With its
/// integrity T, weight w, length L, modulus C and stretch s
///
///   Y = dPi/dT,   s_eq = sqrt(2 max(Y, 0) / (w L C)) if s > 0, otherwise 0,
///
/// takes the place of s in the law. A bond thus takes w L C times the work of its law, whatever
/// else is lost with it, and no loss sets less free than the bond takes. Integrities are constant
/// in a search: the term that knows all of Y lowers them, see TermPasses::release.
///
/// With a strength surface (see StrengthOnsets) the history goes on with the onset and the critical
/// stretch of each bond, each array as long as that of the largest stretches.
class BondFailure final : public FailureModel {
 public:
  /// @param never_fails per bond, 1: no damage whatever the stretch; empty: none
  /// @param onsets null: bonds start at the onsets of their laws. Otherwise these are
  /// DegradedByBond
  BondFailure(std::shared_ptr<const Bonds> bonds, BondPotential potential,
              std::vector<char> never_fails = {}, DamageDrive drive = DamageDrive::stretch,
              std::shared_ptr<const StrengthOnsets> onsets = nullptr)
      : FailureModel(std::move(bonds)),
        potential_(std::move(potential)),
        never_fails_(std::move(never_fails)),
        drive_(drive),
        onsets_(std::move(onsets)) {}

  [[nodiscard]] DamageDrive drive() const { return drive_; }

  [[nodiscard]] const BondPotential& potential() const { return potential_; }

  /// Calls visit(law) if the bonds can be damaged; law.of_bond(bond) is that of one of them.
  /// @param history which must outlive the call: it may have the stretches of the laws
  /// @throws std::logic_error for a history of another length
  template <class Visit>
  void with_damage_law(std::span<const double> history, const Visit& visit) const {
    std::visit(
        [&]<class P>(const P& potential) {
          if constexpr (PotentialWithHistory<P>) visit(at_history(potential, history));
        },
        potential_);
  }

  /// A potential of bonds with the stretches of a history.
  template <class P>
  [[nodiscard]] P at_history(const P& potential, std::span<const double> history) const {
    require_length(history);
    P law = potential;
    if constexpr (requires { law.onset; }) {
      if (onsets_) {
        law.onset = history.data() + padded();
        law.critical = history.data() + 2 * padded();
      }
    }
    return law;
  }

  /// Rule by which bonds start to fail; null: at the onsets of their laws.
  [[nodiscard]] const StrengthOnsets* onsets() const { return onsets_.get(); }

  /// Moves the onsets of bonds that have not started to those of their points, see StrengthOnsets.
  /// @param of_points of all points but images
  void renew_onsets(const Points& points, std::span<const StrengthOnsets::PointOnset> of_points,
                    std::span<double> history) const;

  /// History of bonds that have had these largest stretches.
  /// @param before a history with the stretches of the laws
  /// @throws std::logic_error unless there is one for every bond
  [[nodiscard]] std::vector<double> history_of(std::span<const double> largest_stretches,
                                               std::span<const double> before) const;

  /// Energy that the law has dissipated [J], see weigh.
  [[nodiscard]] double dissipated_energy(std::span<const double> history,
                                         const Points* points) const;

  /// Memory of the law [bytes].
  [[nodiscard]] double bytes() const;

  [[nodiscard]] bool can_fail() const override {
    return std::visit([]<class P>(const P&) { return PotentialWithHistory<P>; }, potential_);
  }
  /// True if they can fail, by what their loss sets free.
  [[nodiscard]] bool fails_by_release() const {
    return can_fail() && drive_ == DamageDrive::release;
  }
  /// True if damaged bonds bear compression like whole ones.
  [[nodiscard]] bool closes() const {
    return std::visit(
        []<class P>(const P& potential) {
          if constexpr (requires { potential.closes; }) return potential.closes;
          return false;
        },
        potential_);
  }
  [[nodiscard]] FailingParts parts() const override { return FailingParts::bonds; }
  [[nodiscard]] bool fails_in_avalanches() const override { return drive_ == DamageDrive::release; }
  [[nodiscard]] std::vector<double> initial_history() const override;
  [[nodiscard]] std::vector<char> broken(const Bonds& bonds,
                                         std::span<const double> history) const override;
  [[nodiscard]] BondLosses weigh(std::span<const double> history, const Points* points,
                                 std::span<double> whole, std::span<double> left) const override;
  [[nodiscard]] const BondFailure* as_bond_failure() const override { return this; }

 private:
  /// Length of the largest stretches, since kernels read whole batches of lanes.
  [[nodiscard]] std::size_t padded() const { return std::size_t(bonds().count()) + lane_count; }
  void require_length(std::span<const double> history) const;

  BondPotential potential_;
  std::vector<char> never_fails_;
  DamageDrive drive_;
  std::shared_ptr<const StrengthOnsets> onsets_;
};

}  // namespace peristat
