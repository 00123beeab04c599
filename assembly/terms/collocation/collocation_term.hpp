#pragma once

#include <memory>
#include <vector>

#include "assembly/terms/bonds/bond_count.hpp"
#include "assembly/terms/collocation/collocation_operator.hpp"
#include "assembly/terms/failure/bond_failure.hpp"
#include "assembly/terms/term.hpp"

namespace peristat {

/// The linear peridynamic solid by collocation, see CollocationOperator. Its forces have no
/// potential; the reported energy is that of [LPS] sec. 2. Tractions come from the environment.
///
/// Bonds break as those of brittle bond models do, by their stretch in the deformed configuration,
/// with the history and the dissipation of BondFailure. The stretches have to be
/// committed before forces change.
class CollocationTerm : public Term {
 public:
  /// @param bonds network of the uncut bonds, which the entries of both networks refer to
  /// @param whole, local the operator, and its surrogate between adjacent points
  CollocationTerm(std::shared_ptr<const Bonds> bonds, BondPotential potential,
                  std::vector<char> never_fails, CollocationSetting whole,
                  CollocationSetting local);

  [[nodiscard]] const BondFailure& bond_failure() const { return *failure_; }
  [[nodiscard]] const CollocationSetting& whole() const { return whole_; }
  [[nodiscard]] const CollocationSetting& local() const { return local_; }

  [[nodiscard]] Couplings couplings() const override { return failure_->bonds(); }
  [[nodiscard]] TangentKind tangent_kind() const override { return TangentKind::rows; }
  [[nodiscard]] Balances balances() const override { return {false, false, false, false}; }
  [[nodiscard]] std::shared_ptr<const FailureModel> failure() const override { return failure_; }
  [[nodiscard]] std::vector<InteractionCount> counts() const override {
    return {bond_count(failure_->bonds())};
  }
  [[nodiscard]] double stored_bytes() const override;
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  std::shared_ptr<const BondFailure> failure_;
  CollocationSetting whole_, local_;
};

}  // namespace peristat
