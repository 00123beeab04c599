#include "cases/runner/results/checkpoint/damage_histories.hpp"

#include "src/geometry/image_number.hpp"

namespace peristat {

BondHistories DamageHistories::changes(const RecordedPoints& recorded, const Bonds& bonds,
                                       std::span<const double> history) const {
  const Points& points = recorded.points();
  const bool has_images = !points.images.kinds.empty();  // the same on all ranks
  BondHistories changed;
  auto known = known_.begin();
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const bool is_known = known != known_.end() && known->first == bond;
      const double before = is_known ? (known++)->second : 0.0;
      if (history[bond] == before || points.is_image(i)) continue;
      const Index second = bonds.partner(i, bond);
      if (!recorded.tells(i, second)) continue;
      changed.first_point.push_back(recorded.number(i));
      changed.second_point.push_back(recorded.number(second));
      changed.largest_stretch.push_back(history[bond]);
      if (has_images) changed.second_image.push_back(image_number(points, second));
    }
  }
  return changed;
}

std::vector<double> DamageHistories::told(Offset bonds) const {
  std::vector<double> history(static_cast<std::size_t>(bonds));
  for (const auto& [bond, stretch] : known_) history[static_cast<std::size_t>(bond)] = stretch;
  return history;
}

void DamageHistories::tell(std::span<const double> history) {
  known_.clear();
  for (std::size_t bond = 0; bond < history.size(); ++bond) {
    if (history[bond] != 0.0) known_.emplace_back(Offset(bond), history[bond]);
  }
}

}  // namespace peristat
