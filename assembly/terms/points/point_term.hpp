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

/// A lattice whose interactions are summed by convolutions, without stored bonds.
struct ConvolvedLattice {
  CutLattice box;
  std::size_t own = 0;  ///< number of points that are no images; they come first
  /// Springs to half the neighbours, one per opposite pair; for a solid, bonds of equivalent
  /// stiffness for its preconditioner.
  std::vector<LatticeSpring> springs;
  std::function<Bonds()> all_bonds{};  ///< finds the uncut bonds

  [[nodiscard]] bool has_images() const { return own < box.place.size(); }
};

/// Forces between pairs of points of a lattice with images; `make` makes those of all points.
[[nodiscard]] std::unique_ptr<LatticeForces> with_images(
    const ConvolvedLattice& lattice, const std::function<std::unique_ptr<LatticeForces>()>& make);

/// Energy that each point bears, infinite if it never fails [J]; nothing: no point fails. The array
/// is empty on a part without points of a body that can fail.
using BearableEnergies = std::optional<std::vector<double>>;

/// An energy whose forces are found for all points at once (LatticeForces). Each point has an
/// integrity q.
///
/// Points lose their integrity, from 1 to 0 and irreversibly, where the energy density of a
/// committed state exceeds what they bear ([FCBM] eq. 21). The energy that a commit removes at
/// fixed displacements counts as dissipated. The history is q of each point, followed by the energy
/// dissipated so far [J].
class PointTerm : public BondTerm {
 public:
  /// @param bonds of the body; for a convolved lattice a few short ones, which define connectivity
  /// @param micromodulus c [N/m6]
  PointTerm(std::shared_ptr<const Bonds> bonds, double micromodulus, BearableEnergies bearable,
            std::optional<ConvolvedLattice> lattice, int threads);

  /// @param shared must outlive the result, as the points must
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

  /// Constant c such that no eigenvalue of M^-1 K exceeds c times the largest of the diagonal
  /// blocks; 0: none holds in every state, and row sums are used instead.
  [[nodiscard]] virtual double bound_over_blocks(int dimension) const = 0;

  [[nodiscard]] Couplings couplings() const override;
  [[nodiscard]] TangentKind tangent_kind() const override {
    return is_convolved() ? TangentKind::products : TangentKind::visited;
  }
  [[nodiscard]] Balances balances() const override = 0;
  [[nodiscard]] bool can_be_damaged() const override { return bearable_.has_value(); }
  [[nodiscard]] std::vector<double> initial_history() const override;
  [[nodiscard]] double stored_bytes() const override;
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 protected:
  /// Memory of the forces by convolutions [bytes].
  [[nodiscard]] virtual double bytes_of_forces() const = 0;

 private:
  double micromodulus_;
  BearableEnergies bearable_;
  std::optional<ConvolvedLattice> lattice_;
  int threads_;
  std::vector<Offset> no_couplings_;      // of a lattice that is convolved
  std::vector<double> whole_weight_;      // per point, of a body without damage [m6]
  std::vector<std::int32_t> neighbours_;  // of each point
  Offset count_ = 0;
};

}  // namespace peristat
