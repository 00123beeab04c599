#include "assembly/terms/model.hpp"

#include <algorithm>
#include <stdexcept>

namespace peristat {

Model::Model(Bonds network, BondPotential potential, std::vector<char> never_fails)
    : Model(std::move(network)) {
  auto term = std::make_shared<BondTerm>(bonds_, std::move(potential), std::move(never_fails));
  bond_term_ = term;
  add(std::move(term));
}

Model::Model(std::shared_ptr<BondTerm> bonds) : bonds_(bonds->shared_bonds()), bond_term_(bonds) {
  add(std::move(bonds));
}

const BondTerm* Model::failing_bonds() const {
  return bond_term_ && bond_term_->can_fail() ? bond_term_.get() : nullptr;
}

bool Model::has_history() const {
  return std::any_of(terms_.begin(), terms_.end(),
                     [](const auto& term) { return term->can_be_damaged(); });
}

std::size_t Model::slot_of(const Term& term) const {
  const auto found = std::find_if(terms_.begin(), terms_.end(),
                                  [&](const auto& own) { return own.get() == &term; });
  if (found == terms_.end()) throw std::logic_error("the model has no such term");
  return std::size_t(found - terms_.begin());
}

BlockPattern Model::pattern() const {
  std::vector<Couplings> couplings;
  for (const auto& term : terms_) couplings.push_back(term->couplings());
  return BlockPattern::united(couplings, bonds().points());
}

bool Model::has_symmetric_blocks() const {
  return std::all_of(terms_.begin(), terms_.end(),
                     [](const auto& term) { return term->has_symmetric_blocks(); });
}

TangentKind Model::tangent_kind() const {
  // The rows of several terms can't be visited at once.
  TangentKind kind = terms_.size() == 1 ? TangentKind::visited : TangentKind::stored;
  for (const auto& term : terms_) kind = std::max(kind, term->tangent_kind());
  return kind;
}

Balances Model::balances() const {
  Balances balances{.linear = true};
  for (const auto& term : terms_) balances.restrict_to(term->balances());
  return balances;
}

}  // namespace peristat
