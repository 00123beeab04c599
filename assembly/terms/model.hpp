#pragma once

#include <memory>
#include <vector>

#include "assembly/terms/bonds/bond_term.hpp"
#include "assembly/terms/term.hpp"

namespace peristat {

/// The discrete energy of a body: a sum of terms on a network of bonds, which defines connectivity,
/// what a crack cuts and what is damaged. Copies share their terms.
class Model {
 public:
  Model() : Model(Bonds{{0}, {}, {}}) {}

  /// Network of bonds without an energy, for terms to be added.
  explicit Model(Bonds network) : bonds_(std::make_shared<const Bonds>(std::move(network))) {}

  /// Bonds with the energy sum_b w psi(l; L).
  /// @param never_fails per bond, 1: no damage whatever the stretch; empty: none
  Model(Bonds network, BondPotential potential, std::vector<char> never_fails = {});

  /// With a bond term that is more than a sum over bonds.
  explicit Model(std::shared_ptr<BondTerm> bonds);

  /// Number of bonds: of the bond term, otherwise of the network.
  [[nodiscard]] Offset count_of_bonds() const {
    return bond_term_ ? bond_term_->count() : bonds_->count();
  }

  void add(std::shared_ptr<Term> term) { terms_.push_back(std::move(term)); }

  [[nodiscard]] const Bonds& bonds() const { return *bonds_; }
  [[nodiscard]] const std::shared_ptr<const Bonds>& shared_bonds() const { return bonds_; }
  [[nodiscard]] const std::vector<std::shared_ptr<Term>>& terms() const { return terms_; }

  /// The energy of the bonds, or null.
  [[nodiscard]] const std::shared_ptr<const BondTerm>& bond_term() const { return bond_term_; }
  /// The same if they can be damaged, otherwise null.
  [[nodiscard]] const BondTerm* failing_bonds() const;

  [[nodiscard]] bool has_history() const;
  /// True if points fail instead of bonds: there is no bond strength that a load could be scaled
  /// to, and all points that exceed what they bear fail together under the same load.
  [[nodiscard]] bool fails_in_avalanches() const { return has_history() && !failing_bonds(); }

  /// Position of a term's array in a History.
  /// @throws std::logic_error if it is none of the terms
  [[nodiscard]] std::size_t slot_of(const Term& term) const;

  /// Union of the blocks of all terms.
  [[nodiscard]] BlockPattern pattern() const;

  [[nodiscard]] bool has_symmetric_blocks() const;
  [[nodiscard]] TangentKind tangent_kind() const;
  [[nodiscard]] Balances balances() const;

 private:
  std::shared_ptr<const Bonds> bonds_;
  std::shared_ptr<const BondTerm> bond_term_;
  std::vector<std::shared_ptr<Term>> terms_;
};

}  // namespace peristat
