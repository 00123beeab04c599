#include "solvers/ranks/heard_of_bonds.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "solvers/ranks/ranks.hpp"

namespace peristat {
namespace {

/// Bond between two points that are here.
Offset bond_between(const Bonds& bonds, std::optional<Index> one, std::optional<Index> other) {
  if (!one || !other) throw std::logic_error("a bond of two parts has a point that is not here");
  const auto [lower, upper] = std::minmax(*one, *other);
  const auto first = bonds.partner.begin() + std::ptrdiff_t(bonds.offset[lower]);
  const auto last = bonds.partner.begin() + std::ptrdiff_t(bonds.offset[lower + 1]);
  const auto found = std::lower_bound(first, last, upper);
  if (found == last || *found != upper) {
    throw std::logic_error("a bond between two parts is on one rank alone");
  }
  return found - bonds.partner.begin();
}

/// Asks for the bonds that are told by others: who asks, numbers of the ends, the bond there.
Records questions(const Bonds& bonds, const NumberedPoints& points, const Communicator& ranks) {
  Records asked{1, 3, {}, {}};
  std::vector<int> to;
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner[std::size_t(bond)];
      if (!points.is_ghost(j)) continue;  // nor to images, which no history is of
      const Index lower = points.number_of(i) < points.number_of(j) ? i : j;
      if (!points.is_ghost(lower)) continue;
      to.push_back(points.owner_of_ghost(lower));
      asked.values.push_back(double(ranks.rank()));
      asked.numbers.insert(asked.numbers.end(), {points.number_of(i), points.number_of(j), bond});
    }
  }
  return exchange(ranks, to, asked);
}

}  // namespace

HeardOfBonds heard_of_bonds(const Bonds& bonds, const NumberedPoints& points,
                            const Communicator& ranks, int width,
                            const std::function<void(Offset, double*)>& tell) {
  const Records asked = questions(bonds, points, ranks);
  const auto each = std::size_t(width);
  Records told{width, 1, std::vector<double>(asked.values.size() * each), {}};
  std::vector<int> to;
  for (std::size_t k = 0; k < asked.values.size(); ++k) {
    const auto* const numbers = &asked.numbers[3 * k];
    tell(bond_between(bonds, points.find(numbers[0]), points.find(numbers[1])),
         &told.values[k * each]);
    told.numbers.push_back(numbers[2]);
    to.push_back(int(asked.values[k]));
  }
  Records heard = exchange(ranks, to, told);
  return {{heard.numbers.begin(), heard.numbers.end()}, std::move(heard.values)};
}

}  // namespace peristat
