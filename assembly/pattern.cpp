#include "assembly/pattern.hpp"

#include <algorithm>

namespace peristat {

std::vector<RowRange> partition_rows(const Pattern& pattern, int threads) {
  std::vector<RowRange> ranges(threads);
  const Index rows = pattern.points();
  Index first = 0;
  for (int thread = 0; thread < threads; ++thread) {
    // Rows count as one block besides their bonds, so that rows without bonds are shared out too.
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
