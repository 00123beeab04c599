#pragma once

#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "assembly/terms/failure/failure_model.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// What drives the damage of a bond.
enum class DamageDrive {
  stretch,  ///< its stretch s
  release   ///< what its loss would set free, as an equivalent stretch: see StateTerm
};

/// Bonds that fail by their stretch, if their potential is one of damage, or by an equivalent one.
///
/// The history is the largest (equivalent) stretch of each bond over the committed states, as far
/// as it has damaged the bond: 0 before, Degraded::never_fails where that is said.
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
