#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "assembly/convolutions/convolved_lattice.hpp"
#include "assembly/terms/failure/failure_model.hpp"
#include "assembly/terms/failure/neighbour_sums.hpp"

namespace peristat {

/// Energy that each point bears, infinite if it never fails [J]; nothing: no point fails. The array
/// is empty on a part without points of a body that can fail.
using BearableEnergies = std::optional<std::vector<double>>;

/// Points lose their integrity, from 1 to 0 and irreversibly, and with it all of their bonds, where
/// the energy density of a committed state exceeds what they bear ([FCBM] eq. 21). The energy that
/// a commit removes at fixed displacements counts as dissipated.
///
/// The history is the integrity q of each point, followed by the energy dissipated so far [J].
class PointFailure final : public FailureModel {
 public:
  /// @param bonds of the body; for a convolved lattice a few short ones, which define connectivity
  /// @param micromodulus c of the lattice's springs [N/m6]
  PointFailure(std::shared_ptr<const Bonds> bonds, double micromodulus, BearableEnergies bearable,
               std::optional<ConvolvedLattice> lattice, int threads);

  [[nodiscard]] const BearableEnergies& bearable() const { return bearable_; }
  [[nodiscard]] const std::optional<ConvolvedLattice>& lattice() const { return lattice_; }
  /// Number of neighbours of each point.
  [[nodiscard]] const std::vector<std::int32_t>& neighbours() const { return neighbours_; }

  [[nodiscard]] std::shared_ptr<const Bonds> whole_network() const override;
  [[nodiscard]] Offset count_of_bonds() const override { return count_; }
  [[nodiscard]] bool can_fail() const override { return bearable_.has_value(); }
  [[nodiscard]] FailingParts parts() const override { return FailingParts::points; }
  [[nodiscard]] bool fails_in_avalanches() const override { return true; }
  [[nodiscard]] std::vector<double> initial_history() const override;
  [[nodiscard]] std::vector<char> broken(const Bonds& bonds,
                                         std::span<const double> history) const override;
  [[nodiscard]] BondLosses weigh(std::span<const double> history, const Points* points,
                                 std::span<double> whole, std::span<double> left) const override;

 private:
  [[nodiscard]] NeighbourSums sums_of(std::span<const double> integrity) const;

  double micromodulus_;
  BearableEnergies bearable_;
  std::optional<ConvolvedLattice> lattice_;
  int threads_;
  std::vector<double> whole_weight_;      // per point, of a body without damage [m6]
  std::vector<std::int32_t> neighbours_;  // of each point
  Offset count_ = 0;
};

}  // namespace peristat
