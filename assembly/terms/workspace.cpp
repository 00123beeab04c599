#include "assembly/terms/workspace.hpp"

namespace peristat {

Workspace::Workspace(const BlockPattern& pattern, int dimension, int threads)
    : ranges(partition_rows(pattern, threads)), sums(ranges.size()), evaluations(ranges.size()) {
  for (std::size_t t = 0; t < ranges.size(); ++t) {
    sums[t].resize(std::size_t(ranges[t].touched_end - ranges[t].first) * block_width(dimension));
  }
}

}  // namespace peristat
