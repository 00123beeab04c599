#include "assembly/terms/model.hpp"

#include <algorithm>
#include <stdexcept>

#include "assembly/terms/bonds/bond_term.hpp"

namespace peristat {

Model::Model(Bonds network, BondPotential potential, std::vector<char> never_fails,
             DamageDrive drive, std::shared_ptr<const StrengthOnsets> onsets)
    : Model(std::make_shared<BondTerm>(std::make_shared<BondFailure>(
          std::make_shared<const Bonds>(std::move(network)), std::move(potential),
          std::move(never_fails), drive, std::move(onsets)))) {}

Model::Model(std::shared_ptr<Term> term) : failure_(term->failure()), terms_{std::move(term)} {
  if (!failure_) throw std::logic_error("a model is made with a term that has a failure model");
}

std::size_t Model::slot_of(const Term& term) const {
  const auto found = std::ranges::find(terms_, &term, &std::shared_ptr<Term>::get);
  if (found == terms_.end()) throw std::logic_error("the model has no such term");
  return std::size_t(found - terms_.begin());
}

std::size_t Model::slot_of(const FailureModel& failure) const {
  const auto found = std::ranges::find_if(
      terms_, [&](const auto& term) { return term->failure().get() == &failure; });
  if (found == terms_.end()) throw std::logic_error("the model has no such failure");
  return std::size_t(found - terms_.begin());
}

BlockPattern Model::pattern() const {
  std::vector<Couplings> couplings;
  for (const auto& term : terms_) couplings.push_back(term->couplings());
  return BlockPattern::united(couplings, bonds().points());
}

BlockPattern Model::visited_pattern() const {
  std::vector<Couplings> couplings;
  for (const auto& term : terms_) couplings.push_back(term->visited_couplings());
  return BlockPattern::united(couplings, bonds().points());
}

bool Model::drives_bonds() const {
  return std::ranges::any_of(terms_, [](const auto& term) { return term->drives_bonds(); });
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
