#include "src/neighbourhood/upper_neighbourhood.hpp"

#include <algorithm>

namespace peristat {

int UpperNeighbourhood::largest(const Bonds& bonds) {
  Offset most = 0;
  for (Index i = 0; i < bonds.points(); ++i) {
    most = std::max(most, bonds.offset[i + 1] - bonds.offset[i]);
  }
  return static_cast<int>(most);
}

UpperNeighbourhood::UpperNeighbourhood(const Bonds& bonds)
    : bonds_(bonds), local_(std::size_t(bonds.points()), -1) {
  const int most = largest(bonds);
  words_ = (most + 63) / 64;
  mutual_.resize(std::size_t(most) * words_);
  pairs_.reserve(std::size_t(most) * most / 2);
}

void UpperNeighbourhood::move_to(Index i) {
  own_ = i;
  const PartnersOfPoint partners = bonds_.of(i);
  points_.assign(partners.begin(), partners.end());
  pairs_.clear();
}

void UpperNeighbourhood::find_pairs() {
  for (int a = 0; a < count(); ++a) local_[points_[a]] = a;
  pairs_.clear();
  std::fill_n(mutual_.begin(), std::size_t(count()) * words_, 0);
  for (int a = 0; a < count(); ++a) {
    const Index point = points_[a];
    std::uint64_t* bits = &mutual_[std::size_t(a) * words_];
    for (Offset bond = bonds_.offset[point]; bond < bonds_.offset[point + 1]; ++bond) {
      const int b = local_[bonds_.partner(point, bond)];
      if (b < 0) continue;
      bits[b / 64] |= std::uint64_t(1) << (b % 64);
      pairs_.push_back({a, b, bond});
    }
  }
  for (Index point : points_) local_[point] = -1;
}

}  // namespace peristat
