#include "src/neighbourhood/neighbour_counts.hpp"

namespace peristat {

std::vector<std::int32_t> neighbour_counts(const Bonds& bonds) {
  std::vector<std::int32_t> count(std::size_t(bonds.points()), 0);
  for (Index i = 0; i < bonds.points(); ++i) {
    count[i] += static_cast<std::int32_t>(bonds.offset[i + 1] - bonds.offset[i]);
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      ++count[bonds.partner(i, bond)];
    }
  }
  return count;
}

Offset weighted_bonds(const Bonds& bonds) {
  Offset count = 0;
  for (Offset bond = 0; bond < bonds.count(); ++bond) count += bonds.weight(bond) != 0.0;
  return count;
}

}  // namespace peristat
