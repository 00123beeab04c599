#include "assembly/terms/bonds/bond_term.hpp"

#include <variant>

#include "assembly/terms/bonds/bond_count.hpp"
#include "assembly/terms/bonds/bond_passes.hpp"

namespace peristat {

Balances BondTerm::balances() const {
  Balances balances;
  balances.positive_energy =
      std::visit([](const auto& law) { return law.modulus >= 0.0; }, bonds_->potential());
  return balances;
}

std::vector<InteractionCount> BondTerm::counts() const { return {bond_count(bonds_->bonds())}; }

std::unique_ptr<TermPasses> BondTerm::passes(const TermSetting& setting) const {
  return make_bond_passes(*bonds_, setting);
}

}  // namespace peristat
