#pragma once

#include <memory>
#include <vector>

#include "assembly/terms/bonds/bond_term.hpp"
#include "assembly/terms/collocation/collocation_operator.hpp"

namespace peristat {

/// The linear peridynamic solid by collocation, see CollocationOperator. Its forces have no
/// potential; the reported energy is that of [LPS] sec. 2. Tractions come from the environment.
///
/// Bonds break as those of brittle bond models do, by their stretch in the deformed configuration:
/// the term's history and dissipation are those of a term of bonds. The stretches have to be
/// committed before forces change.
class CollocationTerm : public BondTerm {
 public:
  /// @param bonds network of the uncut bonds, which the entries of both networks refer to
  /// @param whole, local the operator, and its surrogate between adjacent points
  CollocationTerm(std::shared_ptr<const Bonds> bonds, BondPotential potential,
                  std::vector<char> never_fails, CollocationSetting whole,
                  CollocationSetting local);

  [[nodiscard]] const CollocationSetting& whole() const { return whole_; }
  [[nodiscard]] const CollocationSetting& local() const { return local_; }

  [[nodiscard]] bool has_symmetric_blocks() const override { return false; }
  [[nodiscard]] TangentKind tangent_kind() const override { return TangentKind::rows; }
  [[nodiscard]] Balances balances() const override { return {false, false, false, false}; }
  [[nodiscard]] double stored_bytes() const override;
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  CollocationSetting whole_, local_;
};

}  // namespace peristat
