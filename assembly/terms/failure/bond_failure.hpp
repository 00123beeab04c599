#pragma once

#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "assembly/terms/failure/damage_drive.hpp"
#include "assembly/terms/failure/failure_model.hpp"
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
class BondFailure final : public FailureModel {
 public:
  /// @param never_fails per bond, 1: no damage whatever the stretch; empty: none
  BondFailure(std::shared_ptr<const Bonds> bonds, BondPotential potential,
              std::vector<char> never_fails = {}, DamageDrive drive = DamageDrive::stretch)
      : FailureModel(std::move(bonds)),
        potential_(std::move(potential)),
        never_fails_(std::move(never_fails)),
        drive_(drive) {}

  [[nodiscard]] DamageDrive drive() const { return drive_; }

  [[nodiscard]] const BondPotential& potential() const { return potential_; }

  /// Calls visit(law) if the bonds can be damaged; law.of_bond(bond) is that of one of them.
  template <class Visit>
  void with_damage_law(const Visit& visit) const {
    std::visit(
        [&]<class P>(const P& law) {
          if constexpr (PotentialWithHistory<P>) visit(law);
        },
        potential_);
  }

  /// History of bonds that have had these largest stretches.
  /// @throws std::logic_error unless there is one for every bond
  [[nodiscard]] std::vector<double> history_of(std::span<const double> largest_stretches) const;

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
  [[nodiscard]] FailingParts parts() const override { return FailingParts::bonds; }
  [[nodiscard]] bool fails_in_avalanches() const override { return drive_ == DamageDrive::release; }
  [[nodiscard]] std::vector<double> initial_history() const override;
  [[nodiscard]] std::vector<char> broken(const Bonds& bonds,
                                         std::span<const double> history) const override;
  [[nodiscard]] BondLosses weigh(std::span<const double> history, const Points* points,
                                 std::span<double> whole, std::span<double> left) const override;
  [[nodiscard]] const BondFailure* as_bond_failure() const override { return this; }

 private:
  BondPotential potential_;
  std::vector<char> never_fails_;
  DamageDrive drive_;
};

}  // namespace peristat
