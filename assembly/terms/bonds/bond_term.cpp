#include "assembly/terms/bonds/bond_term.hpp"

#include <algorithm>
#include <stdexcept>

#include "assembly/terms/bonds/bond_passes.hpp"
#include "src/core/lanes.hpp"
#include "src/neighbourhood/neighbour_counts.hpp"

namespace peristat {
namespace {

/// Length of the bonds' history, padded since kernels read whole batches of lanes.
std::size_t padded(const Bonds& bonds) { return std::size_t(bonds.count()) + lane_count; }

}  // namespace

std::vector<double> BondTerm::history_of(std::span<const double> largest_stretches) const {
  if (largest_stretches.size() != std::size_t(bonds_->count())) {
    throw std::logic_error("a history has a stretch for every bond");
  }
  std::vector<double> history(padded(*bonds_), 0.0);
  std::copy(largest_stretches.begin(), largest_stretches.end(), history.begin());
  return history;
}

std::vector<double> BondTerm::initial_history() const {
  std::vector<double> history;
  with_damage_law([&]<class P>(const P&) {
    history.assign(padded(*bonds_), 0.0);
    for (std::size_t bond = 0; bond < never_fails_.size(); ++bond) {
      if (never_fails_[bond]) history[bond] = P::never_fails;
    }
  });
  return history;
}

Balances BondTerm::balances() const {
  Balances balances;
  balances.positive_energy =
      std::visit([](const auto& law) { return law.modulus >= 0.0; }, potential_);
  return balances;
}

std::vector<InteractionCount> BondTerm::counts() const {
  return {{"bonds", weighted_bonds(*bonds_), "neighbours", "neighbours within the horizon, #N1",
           neighbour_counts(*bonds_)}};
}

double BondTerm::stored_bytes() const {
  double bytes = 0.0;
  with_damage_law([&](const auto& law) { bytes = law.bytes(); });
  return bytes;
}

std::unique_ptr<TermPasses> BondTerm::passes(const TermSetting& setting) const {
  return make_bond_passes(*this, setting);
}

}  // namespace peristat
