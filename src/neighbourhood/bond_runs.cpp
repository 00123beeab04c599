#include "src/neighbourhood/bond_runs.hpp"

namespace peristat {
namespace {

/// True if the bonds of both points are alike.
bool are_alike(const Bonds& bonds, Index one, Index other) {
  const Offset first = bonds.offset[one], second = bonds.offset[other];
  const Offset count = bonds.offset[one + 1] - first;
  if (bonds.offset[other + 1] - second != count) return false;
  for (Offset k = 0; k < count; ++k) {
    const Index ahead = bonds.partner[first + k] - one;
    if (bonds.partner[second + k] - other != ahead) return false;
    if (bonds.kind[first + k] != bonds.kind[second + k]) return false;
  }
  return true;
}

}  // namespace

std::vector<BondRun> bond_runs(const Points& points, const Bonds& bonds, int threads) {
  const Index owned = points.owned.value_or(points.count());
  const Index count = bonds.points();
  const auto stays_owned = [&](Index i) {
    const Offset first = bonds.offset[i], last = bonds.offset[i + 1];
    return i < owned && last > first && bonds.partner[last - 1] < owned;
  };
  std::vector<char> continues(std::size_t(count), 0);  // the run of the point before
#pragma omp parallel for num_threads(threads)
  for (Index i = 1; i < count; ++i) {
    continues[i] = stays_owned(i - 1) && stays_owned(i) && are_alike(bonds, i - 1, i);
  }
  std::vector<BondRun> runs;
  for (Index first = 0, last = 0; first < count; first = last) {
    last = first + 1;
    while (last < count && continues[last]) ++last;
    if (last - first >= least_run) runs.push_back({first, last});
  }
  return runs;
}

double share_in_runs(const Points& points, const Bonds& bonds, int threads) {
  double inside = 0.0;
  for (const BondRun& run : bond_runs(points, bonds, threads)) {
    inside += double(bonds.offset[run.last] - bonds.offset[run.first]);
  }
  return bonds.count() > 0 ? inside / double(bonds.count()) : 0.0;
}

}  // namespace peristat
