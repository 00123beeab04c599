#include "assembly/terms/workspace.hpp"

#include <utility>

namespace peristat {

Workspace::Workspace(const BlockPattern& pattern, int dimension, int on_threads,
                     std::vector<RowRange> of_parts)
    : ranges(std::move(of_parts)),
      sums(ranges.size()),
      evaluations(ranges.size()),
      threads_(on_threads) {
  // Terms without couplings, as a lattice by convolutions, rarely sum rows: they allocate on
  // demand.
  if (!pattern.partner.empty()) make_room(vector_width(dimension));
}

void Workspace::make_room(int width) {
  for (std::size_t part = 0; part < ranges.size(); ++part) {
    const auto rows = std::size_t(ranges[part].touched_end - ranges[part].first);
    sums[part].make_room(rows * std::size_t(width));
  }
}

}  // namespace peristat
