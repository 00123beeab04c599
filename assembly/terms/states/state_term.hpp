#pragma once

#include <memory>
#include <span>
#include <vector>

#include "assembly/terms/bonds/bond_count.hpp"
#include "assembly/terms/failure/bond_failure.hpp"
#include "assembly/terms/states/state_network.hpp"
#include "assembly/terms/term.hpp"

namespace peristat {

/// The linear peridynamic solid as an energy, for small displacements: with xi the bond in the
/// reference, r its length, eta the difference of displacements, d the dimension and T_ij the
/// integrity that its history leaves to a bond,
///
///   Pi = sum_i V_i [ (lambda_i - mu_i) theta_i^2 / 2
///                    + d (d + 2) mu_i / 2 (1/M_i) sum_j T_ij kappa_ij (xi . eta)^2 / r^2 ],
///   theta_i = (d / M_i) sum_j T_ij kappa_ij xi . eta,   M_i = sum_j kappa_ij r^2,
///
/// kappa_ij = K(r) V_i V_j nu_ij symmetric, M_i of the whole neighbourhood: neither cracks nor
/// damage change it, so that a bond cut from the start and one that breaks later have the same
/// effect. At surfaces a neighbourhood consists of the neighbours that exist.
///
/// Pi is quadratic, and no point's part of it is negative: theta^2 <= d^2 (1/M) sum T kappa
/// (xi . eta)^2 / r^2 by Cauchy and Schwarz, so that it is at least (lambda + 2 mu / d) theta^2
/// / 2. Forces of bonds are central along their direction in the reference: they add up to zero,
/// and so do their moments about places in the reference, not in the present one.
///
/// Bonds break as those of brittle bond models do, by their stretch in the deformed configuration,
/// see BondFailure. The energy that a commit removes at fixed
/// displacements counts as dissipated, with what each bond held when it passed the stretch that it
/// bears. The part that the bonds' law dissipates, with the network's modulus, is reported as
/// dissipated by the law; the difference, of either sign, as released energy.
class StateTerm : public Term {
 public:
  /// @param bonds uncut bonds, with the weights that dissipation by the law is computed with
  /// @throws std::logic_error for shares of other bonds or points
  StateTerm(std::shared_ptr<const Bonds> bonds, BondPotential potential,
            std::vector<char> never_fails, StateShares shares, int threads);

  [[nodiscard]] const BondFailure& bond_failure() const { return *failure_; }
  [[nodiscard]] const Bonds& bonds() const { return failure_->bonds(); }
  [[nodiscard]] const StateShares& shares() const { return shares_; }
  [[nodiscard]] const StateNetwork& network() const { return network_; }

  /// See StateRatios.
  [[nodiscard]] double bound_over_blocks(int dimension) const;

  [[nodiscard]] Couplings couplings() const override {
    return {network_.block_offset, network_.partner};
  }
  [[nodiscard]] Balances balances() const override { return {true, false, true, true}; }
  [[nodiscard]] std::shared_ptr<const FailureModel> failure() const override { return failure_; }
  [[nodiscard]] std::vector<InteractionCount> counts() const override {
    return {bond_count(bonds())};
  }
  [[nodiscard]] double stored_bytes() const override;
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  std::shared_ptr<const BondFailure> failure_;
  StateShares shares_;
  StateNetwork network_;
};

/// Bounds of Pi over the bonds' part of it: at most R, the largest of 1 and
/// (d lambda + 2 mu) / ((d + 2) mu) of the points, and at least R', the smallest of these.
struct StateRatios {
  double most = 1.0, least = 1.0;

  /// Constant c such that no eigenvalue of M^-1 K, M the masses of points, exceeds c times the
  /// largest of the diagonal blocks: c = 2 for pairs of points, so c = 2 R / R'.
  [[nodiscard]] double bound_over_blocks() const { return 2.0 * most / least; }
};

[[nodiscard]] StateRatios state_ratios(std::span<const LamePair> constants, int dimension);

}  // namespace peristat
