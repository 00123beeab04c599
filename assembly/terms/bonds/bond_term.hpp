#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "assembly/terms/failure/bond_failure.hpp"
#include "assembly/terms/term.hpp"

namespace peristat {

/// The energy of bonds, the sum of w psi(l; L) ([CPD] eq. 14, one neighbour), with the history of
/// BondFailure.
class BondTerm : public Term {
 public:
  explicit BondTerm(std::shared_ptr<const BondFailure> bonds) : bonds_(std::move(bonds)) {}

  [[nodiscard]] Couplings couplings() const override { return bonds_->bonds(); }
  [[nodiscard]] bool has_symmetric_blocks() const override { return true; }
  [[nodiscard]] TangentKind tangent_kind() const override { return TangentKind::visited; }
  [[nodiscard]] Balances balances() const override;
  [[nodiscard]] std::shared_ptr<const FailureModel> failure() const override { return bonds_; }
  [[nodiscard]] std::vector<InteractionCount> counts() const override;
  [[nodiscard]] double stored_bytes() const override { return bonds_->bytes(); }
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  std::shared_ptr<const BondFailure> bonds_;
};

}  // namespace peristat
