#include "assembly/terms/failure/point_failure.hpp"

#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "src/geometry/counts_bond.hpp"

namespace peristat {

PointFailure::PointFailure(std::shared_ptr<const Bonds> bonds, double micromodulus,
                           BearableEnergies bearable, std::optional<ConvolvedLattice> lattice,
                           int threads)
    : FailureModel(std::move(bonds)),
      micromodulus_(micromodulus),
      bearable_(std::move(bearable)),
      lattice_(std::move(lattice)),
      threads_(threads) {
  const auto points = std::size_t(this->bonds().points());
  if (bearable_ && bearable_->size() != points) {
    throw std::logic_error("every point bears an energy of its own");
  }
  NeighbourSums whole = sums_of(std::vector<double>(points, 1.0));
  whole_weight_ = std::move(whole.weight);
  for (const double count : whole.count) neighbours_.push_back(std::int32_t(std::lround(count)));
  count_ = std::accumulate(neighbours_.begin(), neighbours_.end(), Offset(0)) / 2;
}

NeighbourSums PointFailure::sums_of(std::span<const double> integrity) const {
  if (!lattice_) return neighbour_sums(bonds(), integrity);
  return neighbour_sums(lattice_->box, lattice_->springs, micromodulus_, integrity, lattice_->own,
                        threads_);
}

std::shared_ptr<const Bonds> PointFailure::whole_network() const {
  if (!lattice_) return shared_bonds();
  return std::make_shared<const Bonds>(lattice_->all_bonds());
}

std::vector<double> PointFailure::initial_history() const {
  if (!bearable_) return {};
  std::vector<double> history(bearable_->size() + 1, 1.0);
  history.back() = 0.0;
  return history;
}

std::vector<char> PointFailure::broken(const Bonds& bonds, std::span<const double> history) const {
  std::vector<char> broken(history.empty() ? 0 : std::size_t(bonds.count()));
  if (broken.empty()) return broken;
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const auto j = std::size_t(bonds.partner(i, bond));
      broken[std::size_t(bond)] = history[std::size_t(i)] == 0.0 || history[j] == 0.0;
    }
  }
  return broken;
}

BondLosses PointFailure::weigh(std::span<const double> history, const Points* points,
                               std::span<double> whole, std::span<double> left) const {
  const bool is_whole = history.empty();
  const NeighbourSums sums =
      sums_of(is_whole ? std::vector<double>(whole.size(), 1.0) : history.first(whole.size()));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    whole[i] += whole_weight_[i];
    left[i] += sums.weight[i];
  }
  BondLosses lost{.dissipated_energy = is_whole ? 0.0 : history.back(), .round_off = 1e-12};
  if (points == nullptr || !points->owned) {
    const double count = 0.5 * std::accumulate(sums.count.begin(), sums.count.end(), 0.0);
    lost.broken_bonds = static_cast<Index>(std::round(double(count_) - count));
    return lost;
  }
  const std::vector<char> gone = broken(bonds(), history);
  for (Index i = 0; i < bonds().points() && !gone.empty(); ++i) {
    for (Offset bond = bonds().offset[i]; bond < bonds().offset[i + 1]; ++bond) {
      lost.broken_bonds +=
          gone[std::size_t(bond)] && counts_bond(*points, i, bonds().partner(i, bond));
    }
  }
  return lost;
}

}  // namespace peristat
