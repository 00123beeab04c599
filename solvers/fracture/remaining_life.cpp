#include "solvers/fracture/remaining_life.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace peristat {
namespace {

/// Ranges below this are round-off of an equilibrium: parts that have come off are not quite at
/// rest.
constexpr double smallest_range = 1e-12;

/// Calls visit(one, other) for both ends of every bond, those of pre-cracks included.
template <class Visit>
void for_each_pair(const Bonds& bonds, std::span<const BondEnds> cut_bonds, const Visit& visit) {
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      visit(i, bonds.partner(i, bond));
    }
  }
  for (const auto& [i, j] : cut_bonds) visit(i, j);
}

}  // namespace

double LifeLaw::rate(double range) const {
  if (!(range > std::max(limit, smallest_range))) return 0.0;
  return coefficient * std::pow(range - limit, exponent);
}

double FatigueOptions::range(double largest_stretch) const {
  return std::abs((1.0 - load_ratio) * largest_stretch);
}

void note_cracks(const Bonds& bonds, std::span<const BondEnds> cut_bonds,
                 std::span<const double> damage, double crack_damage, std::span<const char> broken,
                 RemainingLives& lives) {
  std::vector<char> near(damage.size());
  for (std::size_t point = 0; point < damage.size(); ++point) {
    near[point] = damage[point] >= crack_damage;
  }
  const std::vector<char> cracked = near;
  for_each_pair(bonds, cut_bonds, [&](Index i, Index j) {
    if (cracked[std::size_t(i)]) near[std::size_t(j)] = 1;
    if (cracked[std::size_t(j)]) near[std::size_t(i)] = 1;
  });
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const auto b = std::size_t(bond);
      const bool is_near = near[std::size_t(i)] || near[std::size_t(bonds.partner(i, bond))];
      if (!is_near || lives.near_crack[b] || broken[b]) continue;
      lives.near_crack[b] = 1;
      lives.life[b] = 1.0;
    }
  }
}

double cycles_to_first(std::span<const double> life, std::span<const double> rates) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t bond = 0; bond < life.size(); ++bond) {
    if (rates[bond] > 0.0) least = std::min(least, life[bond] / rates[bond]);
  }
  return least;
}

std::vector<Offset> worn_bonds(std::span<const double> life, std::span<const double> rates,
                               double tolerance) {
  const double limit = std::max(tolerance, life_tie), last = limit + 10.0 * life_tie;
  std::vector<Offset> worn;
  for (std::size_t bond = 0; bond < life.size(); ++bond) {
    if (rates[bond] > 0.0 && life[bond] <= last) worn.push_back(Offset(bond));
  }
  const auto of = [&](Offset bond) { return std::tuple(life[std::size_t(bond)], bond); };
  std::ranges::sort(worn, [&](Offset a, Offset b) { return of(a) < of(b); });
  std::size_t count = 0;
  while (count < worn.size()) {
    const double next = life[std::size_t(worn[count])];
    const double gap = count == 0 ? 0.0 : next - life[std::size_t(worn[count - 1])];
    if (next > limit && gap > life_tie) break;
    ++count;
  }
  worn.resize(count);
  return worn;
}

}  // namespace peristat
