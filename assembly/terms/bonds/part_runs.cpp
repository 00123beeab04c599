#include "assembly/terms/bonds/part_runs.hpp"

namespace peristat {

PartRuns::PartRuns(const Points& points, const Bonds& bonds, const BondKinds& kinds,
                   const std::vector<RowRange>& ranges, int threads) {
  std::vector<OfPart> found(ranges.size());
  run_on_parts(threads, int(ranges.size()), [&](int part) {
    const RowRange range = ranges[std::size_t(part)];
    OfPart& one = found[std::size_t(part)];
    one.bonds = BondRuns(points, bonds, kinds, range.first, range.last);
    for (const BondRun& run : one.bonds.runs()) one.reach = std::max(one.reach, run.ahead);
  });
  double in_runs = 0.0, in_all = 0.0;
  Index most = 0;  // points in a window
  for (std::size_t part = 0; part < found.size(); ++part) {
    const RowRange range = ranges[part];
    in_runs += double(found[part].bonds.bonds_in_runs());
    in_all += double(bonds.offset[range.last] - bonds.offset[range.first]);
    const Index wanted = 2 * (found[part].reach + BondRuns::longest);
    most = std::max(most, std::min(range.near_end - range.first, wanted));
  }
  if (!(in_runs > 0.0 && in_runs >= BondRuns::least_share * in_all)) return;
  of_parts_ = std::move(found);
  const auto busy = std::min(std::size_t(threads), ranges.size());
  for (std::size_t k = 0; k < busy; ++k) windows_.emplace_back(points.dimension, most);
}

}  // namespace peristat
