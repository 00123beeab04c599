#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "assembly/convolutions/correspondence.hpp"
#include "assembly/terms/points/point_term.hpp"

namespace peristat {

/// Bonds of the lattice's springs, by half the difference of squared lengths (GreenBonds).
struct ConvolvedGreenBonds {};

/// A correspondence material (Correspondence).
struct ConvolvedCorrespondence {
  std::vector<LatticeArm> arms;  ///< of a point, one per opposite pair
  Correspondence::Setting setting;
};

using ConvolvedLaw = std::variant<ConvolvedGreenBonds, ConvolvedCorrespondence>;

/// An energy for any deformation whose forces are polynomials of displacements, and so sums of
/// convolutions. Forces and their moments about present positions add up to zero, except at points
/// of a correspondence material that have lost their gradient: these resist rotations.
///
/// Projection replaces a share of the tangent by the tangent at rest: the semidefinite part of the
/// tangent itself is no convolution.
class ConvolvedTerm : public PointTerm {
 public:
  /// See PointTerm.
  ConvolvedTerm(std::shared_ptr<const Bonds> bonds, double micromodulus, BearableEnergies bearable,
                ConvolvedLattice lattice, ConvolvedLaw law, int threads);

  [[nodiscard]] std::unique_ptr<LatticeForces> forces(const Points& points,
                                                      Workspace& shared) const override;
  /// Diagonal blocks give no bound where bonds are compressed.
  [[nodiscard]] double bound_over_blocks(int /*dimension*/) const override { return 0.0; }
  [[nodiscard]] Balances balances() const override;

 protected:
  [[nodiscard]] double bytes_of_forces() const override;

 private:
  [[nodiscard]] const ConvolvedCorrespondence* correspondence() const {
    return std::get_if<ConvolvedCorrespondence>(&law_);
  }

  ConvolvedLaw law_;
};

}  // namespace peristat
