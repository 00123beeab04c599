#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "assembly/convolutions/cut_lattice.hpp"
#include "assembly/convolutions/lattice_forces.hpp"
#include "assembly/convolutions/lattice_springs.hpp"
#include "assembly/terms/bonds/bond_term.hpp"
#include "assembly/terms/points/neighbour_sums.hpp"

namespace peristat {

/// A lattice whose bonds are convolutions, which need no bond.
struct ConvolvedLattice {
  CutLattice box;
  std::size_t own = 0;  ///< points that are no images of others, the first ones
  /// Of a point, of two opposite ones one; of a solid as stiff as it is, to precondition it with.
  std::vector<LatticeSpring> springs;
  std::function<Bonds()> all_bonds{};  ///< finds those that are left

  [[nodiscard]] bool has_images() const { return own < box.place.size(); }
};

/// Forces of pairs of a lattice's points, which `make` makes of all of them.
[[nodiscard]] std::unique_ptr<LatticeForces> with_images(
    const ConvolvedLattice& lattice, const std::function<std::unique_ptr<LatticeForces>()>& make);

/// Energy of each point that it bears, infinite if it never fails [J]; nothing: no point fails. A
/// part of a body may have no point, of one that fails.
using BearableEnergies = std::optional<std::vector<double>>;

/// An energy whose forces are found for all points at once (LatticeForces), each of which has an
/// integrity q.
///
/// Points lose it, from 1 to 0 and for good, where the energy density of a state that is committed
/// exceeds what they bear ([FCBM] eq. 21). What a commit takes away at fixed displacements counts
/// as dissipated. It remembers q of each point and, behind them, what it has dissipated so far [J].
class PointTerm : public BondTerm {
 public:
  /// @param bonds of the body; of a lattice that is convolved some short ones, which tell what
  ///              hangs together
  /// @param micromodulus c [N/m6]
  PointTerm(std::shared_ptr<const Bonds> bonds, double micromodulus, BearableEnergies bearable,
            std::optional<ConvolvedLattice> lattice, int threads);

  /// @param shared outlives them, as the points do
  [[nodiscard]] virtual std::unique_ptr<LatticeForces> forces(const Points& points,
                                                              Workspace& shared) const = 0;

  [[nodiscard]] double micromodulus() const { return micromodulus_; }
  [[nodiscard]] const BearableEnergies& bearable() const { return bearable_; }
  [[nodiscard]] bool is_convolved() const { return lattice_.has_value(); }
  [[nodiscard]] const std::optional<ConvolvedLattice>& lattice() const { return lattice_; }

  [[nodiscard]] Offset count() const override { return count_; }
  [[nodiscard]] std::vector<InteractionCount> counts() const override;
  [[nodiscard]] const std::vector<double>& whole_weight() const { return whole_weight_; }
  [[nodiscard]] NeighbourSums neighbours(std::span<const double> integrity) const;

  /// A number c so that no eigenvalue of M^-1 K exceeds c times the largest of the diagonal blocks;
  /// 0: none is known in every state, and rows' sums tell.
  [[nodiscard]] virtual double bound_over_blocks(int dimension) const = 0;

  [[nodiscard]] Couplings couplings() const override;
  [[nodiscard]] bool visits_rows() const override { return !is_convolved(); }
  [[nodiscard]] bool has_rows() const override { return !is_convolved(); }
  [[nodiscard]] Balances balances() const override = 0;
  [[nodiscard]] bool can_be_damaged() const override { return bearable_.has_value(); }
  [[nodiscard]] std::vector<double> initial_history() const override;
  [[nodiscard]] double stored_bytes() const override;
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 protected:
  /// Of the forces by convolutions [bytes].
  [[nodiscard]] virtual double bytes_of_forces() const = 0;

 private:
  double micromodulus_;
  BearableEnergies bearable_;
  std::optional<ConvolvedLattice> lattice_;
  int threads_;
  std::vector<Offset> no_couplings_;      // of a lattice that is convolved
  std::vector<double> whole_weight_;      // per point, of a body without damage [m6]
  std::vector<std::int32_t> neighbours_;  // that each has
  Offset count_ = 0;
};

}  // namespace peristat
