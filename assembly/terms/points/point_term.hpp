#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "assembly/convolutions/convolved_lattice.hpp"
#include "assembly/convolutions/lattice_forces.hpp"
#include "assembly/terms/failure/point_failure.hpp"
#include "assembly/terms/term.hpp"

namespace peristat {

/// Forces between pairs of points of a lattice with images; `make` makes those of all points.
[[nodiscard]] std::unique_ptr<LatticeForces> with_images(
    const ConvolvedLattice& lattice, const std::function<std::unique_ptr<LatticeForces>()>& make);

/// An energy whose forces are found for all points at once (LatticeForces), with an integrity q of
/// each point, see PointFailure.
class PointTerm : public Term {
 public:
  /// See PointFailure.
  PointTerm(std::shared_ptr<const Bonds> bonds, double micromodulus, BearableEnergies bearable,
            std::optional<ConvolvedLattice> lattice, int threads);

  /// @param shared must outlive the result, as the points must
  [[nodiscard]] virtual std::unique_ptr<LatticeForces> forces(const Points& points,
                                                              Workspace& shared) const = 0;

  [[nodiscard]] double micromodulus() const { return micromodulus_; }
  [[nodiscard]] const PointFailure& point_failure() const { return *failure_; }
  [[nodiscard]] const Bonds& bonds() const { return failure_->bonds(); }
  [[nodiscard]] bool has_lattice() const { return lattice().has_value(); }
  [[nodiscard]] const std::optional<ConvolvedLattice>& lattice() const {
    return failure_->lattice();
  }

  /// Constant c such that no eigenvalue of M^-1 K exceeds c times the largest of the diagonal
  /// blocks; 0: none holds in every state, and row sums are used instead.
  [[nodiscard]] virtual double bound_over_blocks(int dimension) const = 0;

  [[nodiscard]] Couplings couplings() const override;
  [[nodiscard]] TangentKind tangent_kind() const override {
    return has_lattice() ? TangentKind::products : TangentKind::visited;
  }
  [[nodiscard]] bool has_symmetric_blocks() const override { return true; }
  [[nodiscard]] std::shared_ptr<const FailureModel> failure() const override { return failure_; }
  [[nodiscard]] std::vector<InteractionCount> counts() const override;
  [[nodiscard]] double stored_bytes() const override;
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 protected:
  /// Memory of the forces by convolutions [bytes].
  [[nodiscard]] virtual double bytes_of_forces() const = 0;

 private:
  double micromodulus_;
  std::shared_ptr<const PointFailure> failure_;
  std::vector<Offset> no_couplings_;  // of a lattice that is convolved
};

}  // namespace peristat
