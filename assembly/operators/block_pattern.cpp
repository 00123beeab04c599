#include "assembly/operators/block_pattern.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace peristat {
namespace {

bool are_same_view(const Couplings& a, const Couplings& b) {
  return a.offset.data() == b.offset.data() && a.partner.data() == b.partner.data();
}

}  // namespace

BlockPattern BlockPattern::united(const std::vector<Couplings>& terms, Index points) {
  std::vector<Couplings> different;
  for (const Couplings& couplings : terms) {
    const bool is_known =
        std::any_of(different.begin(), different.end(),
                    [&](const Couplings& known) { return are_same_view(known, couplings); });
    if (!couplings.partner.empty() && !is_known) different.push_back(couplings);
  }
  if (different.size() == 1) return BlockPattern(different.front());
  // No couplings, as on a lattice by convolutions: the term's own empty rows are used.
  if (different.empty() && !terms.empty()) return BlockPattern(terms.front());
  Rows rows;
  rows.offset.push_back(0);
  for (Index i = 0; i < points; ++i) {
    const auto first = std::ptrdiff_t(rows.partner.size());
    for (const Couplings& couplings : different) {
      const std::span<const Index> row = couplings.of(i);
      rows.partner.insert(rows.partner.end(), row.begin(), row.end());
    }
    std::sort(rows.partner.begin() + first, rows.partner.end());
    rows.partner.erase(std::unique(rows.partner.begin() + first, rows.partner.end()),
                       rows.partner.end());
    rows.offset.push_back(Offset(rows.partner.size()));
  }
  return BlockPattern(std::make_shared<const Rows>(std::move(rows)));
}

BlockPattern BlockPattern::of_rows(std::vector<Offset> offset, std::vector<Index> partner) {
  return BlockPattern(std::make_shared<const Rows>(Rows{std::move(offset), std::move(partner)}));
}

std::vector<Offset> BlockPattern::places_of(const Couplings& couplings) const {
  std::vector<Offset> places;
  if (are_same_view(*this, couplings)) return places;
  places.reserve(couplings.partner.size());
  for (Index i = 0; i < couplings.points(); ++i) {
    const Index* const end = partner.data() + offset[i + 1];
    const Index* place = partner.data() + offset[i];
    for (const Index j : couplings.of(i)) {
      place = std::find(place, end, j);
      if (place == end) throw std::logic_error("a term couples points that the pattern does not");
      places.push_back(place - partner.data());
    }
  }
  return places;
}

std::vector<RowRange> partition_rows(const BlockPattern& pattern, int threads) {
  std::vector<RowRange> ranges(threads);
  const Index rows = pattern.points();
  Index first = 0;
  for (int thread = 0; thread < threads; ++thread) {
    // Each row counts one block beside its own, so that rows without any are shared out, too.
    const double share = double(thread + 1) / threads * double(pattern.blocks() + rows);
    Index last = first;
    while (last < rows && double(pattern.offset[last + 1] + last + 1) <= share) ++last;
    if (thread + 1 == threads) last = rows;
    Index reach = last;
    for (Index row = first; row < last; ++row) {
      if (pattern.offset[row + 1] > pattern.offset[row]) {
        reach = std::max(reach, pattern.partner[pattern.offset[row + 1] - 1] + 1);
      }
    }
    ranges[thread] = {first, last, reach};
    first = last;
  }
  return ranges;
}

}  // namespace peristat
