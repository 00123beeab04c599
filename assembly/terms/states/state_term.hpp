#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "assembly/terms/bonds/bond_count.hpp"
#include "assembly/terms/failure/bond_failure.hpp"
#include "assembly/terms/states/state_network.hpp"
#include "assembly/terms/term.hpp"

namespace peristat {

/// How the extension e of a bond follows from displacements.
enum class Extension {
  linear,  ///< e = xi . eta / r along xi / r, for small displacements: the linear solid
  finite   ///< e = |xi + eta| - r along xi + eta, for any
};

struct StateRules {
  Extension extension = Extension::linear;
  DamageDrive drive = DamageDrive::stretch;
  std::shared_ptr<const StrengthOnsets> onsets{};  ///< see BondFailure
};

/// Ordinary state-based peridynamics as one energy: with xi the bond in the reference, r its
/// length, eta the difference of displacements, e its extension, d the dimension and T_ij the
/// integrity that its history leaves to a bond,
///
///   Pi = sum_i V_i [ (lambda_i - mu_i) theta_i^2 / 2
///                    + d (d + 2) mu_i / 2 (1/M_i) sum_j T_ij kappa_ij e_ij^2 ],
///   theta_i = (d / M_i) sum_j T_ij kappa_ij r e_ij,   M_i = sum_j kappa_ij r^2,
///
/// kappa_ij = K(r) V_i V_j nu_ij symmetric, M_i of the whole neighbourhood: neither cracks nor
/// damage change it, so that a bond cut from the start and one that breaks later have the same
/// effect. At surfaces a neighbourhood consists of the neighbours that exist. An eigenstretch of
/// the points is subtracted from e / r.
///
/// No point's part of Pi is negative: theta^2 <= d^2 (1/M) sum T kappa e^2 by Cauchy and Schwarz,
/// so that it is at least (lambda + 2 mu / d) theta^2 / 2; and Pi = 0 only if no unbroken bond has
/// changed its length. With the linear extension Pi is quadratic, its forces have the direction of
/// bonds in the reference, and their moments add up to zero about places in the reference, not in
/// the present one. ([LPS] eq. 6; Silling and others, J. Elasticity 88, 2007, for finite e.)
///
/// Damage by release: with s = e / r, p = V (lambda - mu) (d/M) theta, q = V d (d + 2) mu / M, the
/// loss of a bond's integrity sets free
///
///   Y = dPi/dT = kappa r^2 s [p_i + p_j + (q_i + q_j) s / 2],
///
/// and the equivalent stretch s_eq, s_eq^2 = 2 max(Y, 0) / (kappa r^2 (q_i + q_j)) where s > 0,
/// takes the place of s in the law of damage. A bond takes kappa r^2 (q_i + q_j) times the work of
/// the law up to s_eq, whatever lambda is: the weights of the bonds are such that their potential
/// says so. Brittle bonds break if all that the whole bond would set free, Y - (kappa r^2 s)^2 sum
/// V (lambda - mu) (d/M)^2 / 2, suffices. Within a search the integrities are constant; a commit
/// lowers them bond by bond.
///
/// Damage by stretch: bonds break as those of brittle bond models do, by their stretch in the
/// deformed configuration, see BondFailure. The energy that a commit removes at fixed displacements
/// counts as dissipated, with what each bond held when it passed the stretch that it bears. The
/// part that the bonds' law dissipates, with the network's modulus, is reported as dissipated by
/// the law; the difference, of either sign, as released energy.
class StateTerm : public Term {
 public:
  /// @param bonds uncut bonds, with the weights that dissipation by the law is computed with
  /// @throws std::logic_error for shares of other bonds or points
  StateTerm(std::shared_ptr<const Bonds> bonds, BondPotential potential,
            std::vector<char> never_fails, StateShares shares, StateRules rules, int threads);

  [[nodiscard]] Extension extension() const { return extension_; }
  [[nodiscard]] const BondFailure& bond_failure() const { return *failure_; }
  [[nodiscard]] const Bonds& bonds() const { return failure_->bonds(); }
  [[nodiscard]] const StateShares& shares() const { return shares_; }
  /// Found when it is first asked for: only the blocks of its tangent need it.
  [[nodiscard]] const StateNetwork& network() const;

  [[nodiscard]] Couplings couplings() const override {
    return {network().block_offset, network().partner};
  }
  [[nodiscard]] Couplings visited_couplings() const override { return bonds(); }
  [[nodiscard]] BlockCount block_count(int dimension) const override;
  [[nodiscard]] TangentKind tangent_kind() const override { return TangentKind::nearby; }
  [[nodiscard]] bool drives_bonds() const override { return true; }
  [[nodiscard]] Balances balances() const override {
    return {true, extension_ == Extension::finite, true, true};
  }
  [[nodiscard]] std::shared_ptr<const FailureModel> failure() const override { return failure_; }
  [[nodiscard]] std::vector<InteractionCount> counts() const override {
    return {bond_count(bonds())};
  }
  [[nodiscard]] double stored_bytes() const override;
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  Extension extension_;
  std::shared_ptr<const BondFailure> failure_;
  StateShares shares_;
  bool reaches_twice_;
  int threads_;
  mutable std::once_flag finds_network_;
  mutable std::optional<StateNetwork> network_;
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
