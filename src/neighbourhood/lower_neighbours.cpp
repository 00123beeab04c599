#include "src/neighbourhood/lower_neighbours.hpp"

namespace peristat {

LowerNeighbours::LowerNeighbours(const Bonds& bonds) {
  const Index points = bonds.points();
  offset.assign(std::size_t(points) + 1, 0);
  for (Index i = 0; i < points; ++i) {
    for (const Index upper : bonds.of(i)) ++offset[std::size_t(upper) + 1];
  }
  for (Index i = 0; i < points; ++i) offset[i + 1] += offset[i];
  std::vector<Offset> next(offset.begin(), offset.end() - 1);
  lower.resize(std::size_t(bonds.count()));
  bond.resize(std::size_t(bonds.count()));
  for (Index i = 0; i < points; ++i) {
    for (Offset b = bonds.offset[i]; b < bonds.offset[i + 1]; ++b) {
      const auto place = std::size_t(next[bonds.partner(i, b)]++);
      lower[place] = i;
      bond[place] = b;
    }
  }
}

}  // namespace peristat
