#include "assembly/operators/block_pattern.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace peristat {

BlockPattern BlockPattern::united(const std::vector<Couplings>& terms, Index points) {
  std::vector<Couplings> different;
  for (const Couplings& couplings : terms) {
    const bool is_known =
        std::any_of(different.begin(), different.end(),
                    [&](const Couplings& known) { return known.is_same_view(couplings); });
    if (!couplings.partner.empty() && !is_known) different.push_back(couplings);
  }
  if (different.size() == 1) return BlockPattern(different.front());
  // No couplings, as on a lattice by convolutions: the term's own empty rows are used.
  if (different.empty() && !terms.empty()) return BlockPattern(terms.front());
  std::vector<Offset> offset{0};
  PartnersBuilder partners;
  std::vector<Index> row;
  for (Index i = 0; i < points; ++i) {
    row.clear();
    for (const Couplings& couplings : different) {
      for (const Index j : couplings.of(i)) row.push_back(j);
    }
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    partners.add(row);
    offset.push_back(offset.back() + Offset(row.size()));
  }
  return BlockPattern(std::make_shared<const Rows>(Rows{std::move(offset), partners.take()}));
}

BlockPattern BlockPattern::of_rows(std::vector<Offset> offset, std::span<const Index> upper) {
  Partners partners(offset, upper);
  return BlockPattern(std::make_shared<const Rows>(Rows{std::move(offset), std::move(partners)}));
}

BlockPattern BlockPattern::kept() const {
  if (own_) return *this;
  PartnersBuilder partners;
  for (Index i = 0; i < points(); ++i) partners.add(of(i));
  return BlockPattern(
      std::make_shared<const Rows>(Rows{{offset.begin(), offset.end()}, partners.take()}));
}

bool operator==(const BlockPattern& one, const BlockPattern& other) {
  if (!std::ranges::equal(one.offset, other.offset)) return false;
  for (Index i = 0; i < one.points(); ++i) {
    if (!std::ranges::equal(one.of(i), other.of(i))) return false;
  }
  return true;
}

std::vector<Offset> BlockPattern::places_of(const Couplings& couplings) const {
  std::vector<Offset> places;
  if (is_same_view(couplings)) return places;
  places.reserve(std::size_t(couplings.partner.size()));
  for (Index i = 0; i < couplings.points(); ++i) {
    const PartnersOfPoint mine = of(i);
    auto place = mine.begin();
    for (const Index j : couplings.of(i)) {
      place = std::find(place, mine.end(), j);
      if (place == mine.end()) {
        throw std::logic_error("a term couples points that the pattern does not");
      }
      places.push_back(offset[i] + (place - mine.begin()));
    }
  }
  return places;
}

}  // namespace peristat
