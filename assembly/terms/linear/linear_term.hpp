#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "assembly/convolutions/linear_solid.hpp"
#include "assembly/terms/points/point_term.hpp"

namespace peristat {

/// The linear peridynamic solid, which replaces the bonds.
struct ConvolvedSolid {
  std::vector<LatticeArm> arms;  ///< of a point, one per opposite pair
  LinearSolid::Setting setting;
};

/// The energy of harmonic bonds that are linearised at rest,
///
///   Pi = sum_b q_i q_j k (n . (u_j - u_i))^2 / 2,   k = c w / L,
///
/// n the direction of the bond in the reference. Sums are bond by bond (LinearBondSums) or by
/// convolutions ([FCBM] app. A, LinearBonds): both are the same numbers to round-off. With `solid`
/// it is the energy of the linear solid by convolutions (LinearSolid). Forces add up to zero, and
/// so do their moments about reference positions, but not about present ones. Forces of the solid's
/// form `printed` do neither and have no potential: the energy is that of the solid, and does not
/// account for the work of these forces.
class LinearTerm : public PointTerm {
 public:
  /// See PointTerm.
  /// @param solid summed by convolutions; its springs are those of the lattice
  LinearTerm(std::shared_ptr<const Bonds> bonds, double micromodulus, BearableEnergies bearable,
             std::optional<ConvolvedLattice> lattice, int threads,
             std::optional<ConvolvedSolid> solid = {});

  [[nodiscard]] std::unique_ptr<LatticeForces> forces(const Points& points,
                                                      Workspace& shared) const override;
  /// 2 for pairs of points; for the solid see StateRatios; 0, no bound, for its form `printed`.
  [[nodiscard]] double bound_over_blocks(int dimension) const override;
  [[nodiscard]] Balances balances() const override;

 protected:
  [[nodiscard]] double bytes_of_forces() const override;

 private:
  [[nodiscard]] bool is_printed() const {
    return solid_ && solid_->setting.form == SolidForces::printed;
  }

  std::optional<ConvolvedSolid> solid_;
};

}  // namespace peristat
