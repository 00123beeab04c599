#include "assembly/terms/workspace.hpp"

namespace peristat {

Workspace::Workspace(const BlockPattern& pattern, int dimension, int threads)
    : ranges(partition_rows(pattern, threads)), sums(ranges.size()), evaluations(ranges.size()) {
  // Terms without couplings, as a lattice by convolutions, rarely sum rows: they allocate on
  // demand.
  if (!pattern.partner.empty()) make_room(vector_width(dimension));
}

void Workspace::make_room(int width) {
  for (std::size_t t = 0; t < ranges.size(); ++t) {
    const auto rows = std::size_t(ranges[t].touched_end - ranges[t].first);
    if (sums[t].size() >= rows * std::size_t(width)) continue;
    sums[t] = AlignedVector<double>();  // not beside the larger one
    sums[t].resize(rows * std::size_t(width));
  }
}

}  // namespace peristat
