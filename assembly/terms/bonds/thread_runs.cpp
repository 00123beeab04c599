#include "assembly/terms/bonds/thread_runs.hpp"

namespace peristat {

ThreadRuns::ThreadRuns(const Points& points, const Bonds& bonds, const BondKinds& kinds,
                       const std::vector<RowRange>& ranges) {
  const int threads = int(ranges.size());
  std::vector<OfThread> found(ranges.size());
#pragma omp parallel for num_threads(threads)
  for (int t = 0; t < threads; ++t) {
    const RowRange range = ranges[std::size_t(t)];
    OfThread& one = found[std::size_t(t)];
    one.bonds = BondRuns(points, bonds, kinds, range.first, range.last);
    for (const BondRun& run : one.bonds.runs()) one.reach = std::max(one.reach, run.ahead);
    const Index most = 2 * (one.reach + BondRuns::longest);
    one.window = RunWindow(points.dimension, std::min(range.touched_end - range.first, most));
  }
  double in_runs = 0.0, in_all = 0.0;
  for (int t = 0; t < threads; ++t) {
    in_runs += double(found[std::size_t(t)].bonds.bonds_in_runs());
    const RowRange range = ranges[std::size_t(t)];
    in_all += double(bonds.offset[range.last] - bonds.offset[range.first]);
  }
  if (in_runs > 0.0 && in_runs >= BondRuns::least_share * in_all) of_threads_ = std::move(found);
}

}  // namespace peristat
