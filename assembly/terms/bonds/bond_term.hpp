#pragma once

#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "assembly/terms/term.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// The energy of bonds, the sum of w psi(l; L) ([CPD] eq. 14, one neighbour).
///
/// With a potential of damage the history is the largest stretch of each bond over the committed
/// states, as far as it has damaged the bond: 0 before, Degraded::never_fails where the term says
/// so.
class BondTerm : public Term {
 public:
  /// @param never_fails per bond, 1: no damage whatever the stretch; empty: none
  BondTerm(std::shared_ptr<const Bonds> bonds, BondPotential potential,
           std::vector<char> never_fails = {})
      : bonds_(std::move(bonds)),
        potential_(std::move(potential)),
        never_fails_(std::move(never_fails)) {}

  [[nodiscard]] const Bonds& bonds() const { return *bonds_; }
  [[nodiscard]] const std::shared_ptr<const Bonds>& shared_bonds() const { return bonds_; }
  /// Number of bonds, whether stored or not.
  [[nodiscard]] virtual Offset count() const { return bonds_->count(); }
  [[nodiscard]] const BondPotential& potential() const { return potential_; }
  [[nodiscard]] bool can_fail() const {
    return std::visit([]<class P>(const P&) { return PotentialWithHistory<P>; }, potential_);
  }

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

  [[nodiscard]] Couplings couplings() const override { return *bonds_; }
  [[nodiscard]] bool has_symmetric_blocks() const override { return true; }
  [[nodiscard]] TangentKind tangent_kind() const override { return TangentKind::visited; }
  [[nodiscard]] Balances balances() const override;
  [[nodiscard]] bool can_be_damaged() const override { return can_fail(); }
  [[nodiscard]] std::vector<double> initial_history() const override;
  [[nodiscard]] std::vector<InteractionCount> counts() const override;
  [[nodiscard]] double stored_bytes() const override;
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  std::shared_ptr<const Bonds> bonds_;
  BondPotential potential_;
  std::vector<char> never_fails_;
};

}  // namespace peristat
