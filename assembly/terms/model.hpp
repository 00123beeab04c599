#pragma once

#include <memory>
#include <vector>

#include "assembly/terms/failure/bond_failure.hpp"
#include "assembly/terms/struts.hpp"
#include "assembly/terms/term.hpp"

namespace peristat {

/// The discrete energy of a body: a sum of terms on a network of bonds, which defines connectivity
/// and what a crack cuts, and the failure model of the term that it was made with. Copies share
/// their terms.
class Model {
 public:
  Model() : Model(Bonds{{0}, {}, {}}) {}

  /// Network of bonds without an energy, for terms to be added.
  explicit Model(Bonds network)
      : failure_(std::make_shared<BondFailure>(std::make_shared<const Bonds>(std::move(network)),
                                               Harmonic{})) {}

  /// Bonds with the energy sum_b w psi(l; L).
  /// @param never_fails per bond, 1: no damage whatever the stretch; empty: none
  /// @param drive by release beside a term that lowers their integrities, or of bonds alone
  /// @param onsets see BondFailure
  Model(Bonds network, BondPotential potential, std::vector<char> never_fails = {},
        DamageDrive drive = DamageDrive::stretch,
        std::shared_ptr<const StrengthOnsets> onsets = nullptr);

  /// A term that has a failure model, and the network of that.
  /// @throws std::logic_error if it has none
  explicit Model(std::shared_ptr<Term> term);

  void add(std::shared_ptr<Term> term) { terms_.push_back(std::move(term)); }

  /// Sums bonds one after another, also where consecutive points have alike ones; see bond_runs.
  void sum_one_by_one() { sums_along_runs_ = false; }
  [[nodiscard]] bool sums_along_runs() const { return sums_along_runs_; }

  /// Bonds that join the faces of open cracks fail with these.
  void cut_struts(std::shared_ptr<const Struts> struts) { struts_ = std::move(struts); }
  /// Null: they don't.
  [[nodiscard]] const Struts* struts() const { return has_history() ? struts_.get() : nullptr; }

  [[nodiscard]] const Bonds& bonds() const { return failure_->bonds(); }
  [[nodiscard]] const std::shared_ptr<const Bonds>& shared_bonds() const {
    return failure_->shared_bonds();
  }
  [[nodiscard]] const std::vector<std::shared_ptr<Term>>& terms() const { return terms_; }

  /// The first term of a kind, or null.
  template <class Kind>
  [[nodiscard]] const Kind* find() const {
    for (const auto& term : terms_) {
      if (const auto* const found = dynamic_cast<const Kind*>(term.get())) return found;
    }
    return nullptr;
  }

  [[nodiscard]] const FailureModel& failure() const { return *failure_; }
  /// Its array of a history; empty if nothing can fail.
  [[nodiscard]] std::span<const double> failure_history(const History& history) const {
    return has_history() ? history.of(slot_of(*failure_)) : std::span<const double>();
  }
  /// The same if bonds fail by their stretch, whether or not they can; otherwise null.
  [[nodiscard]] std::shared_ptr<const BondFailure> bond_failure() const {
    return {failure_, failure_->as_bond_failure()};
  }
  /// The same if they can fail, otherwise null.
  [[nodiscard]] const BondFailure* failing_bonds() const {
    return has_history() ? failure_->as_bond_failure() : nullptr;
  }

  [[nodiscard]] bool has_history() const { return failure_->can_fail(); }
  /// True if bonds fail by what their loss sets free.
  [[nodiscard]] bool fails_by_release() const {
    const BondFailure* const bonds = failure_->as_bond_failure();
    return bonds != nullptr && bonds->fails_by_release();
  }
  /// True if a term drives bonds beside their stretches; otherwise they fail by these alone.
  [[nodiscard]] bool drives_bonds() const;
  [[nodiscard]] bool fails_in_avalanches() const {
    return has_history() && failure_->fails_in_avalanches();
  }

  /// Position of a term's array in a History, and of that of the term that fails by a model.
  /// @throws std::logic_error if it is none of the terms
  [[nodiscard]] std::size_t slot_of(const Term& term) const;
  [[nodiscard]] std::size_t slot_of(const FailureModel& failure) const;

  /// Union of the blocks of all terms.
  [[nodiscard]] BlockPattern pattern() const;
  /// The same of the rows that are visited where blocks are not stored.
  [[nodiscard]] BlockPattern visited_pattern() const;

  [[nodiscard]] bool has_symmetric_blocks() const;
  [[nodiscard]] TangentKind tangent_kind() const;
  [[nodiscard]] Balances balances() const;

 private:
  std::shared_ptr<const FailureModel> failure_;
  std::vector<std::shared_ptr<Term>> terms_;
  std::shared_ptr<const Struts> struts_;
  bool sums_along_runs_ = true;
};

}  // namespace peristat
