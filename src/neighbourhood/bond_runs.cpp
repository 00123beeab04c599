#include "src/neighbourhood/bond_runs.hpp"

#include <cmath>

namespace peristat {
namespace {

/// True if the bonds of both points are alike.
bool are_alike(const Points& points, const Bonds& bonds, Index one, Index other) {
  const Offset first = bonds.offset[one], second = bonds.offset[other];
  const Offset count = bonds.offset[one + 1] - first;
  if (bonds.offset[other + 1] - second != count) return false;
  const int dimension = points.dimension;
  const double* const x = points.reference.data();
  for (Offset k = 0; k < count; ++k) {
    const Index near = bonds.partner[first + k], far = bonds.partner[second + k];
    if (far - other != near - one || !(bonds.kind[first + k] == bonds.kind[second + k]))
      return false;
    const double allowed = alike_within * bonds.length(first + k);
    for (int c = 0; c < dimension; ++c) {
      const auto at = [&](Index i) { return x[std::size_t(i) * dimension + c]; };
      if (!(std::abs((at(far) - at(other)) - (at(near) - at(one))) <= allowed)) return false;
    }
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
    continues[i] = stays_owned(i - 1) && stays_owned(i) && are_alike(points, bonds, i - 1, i);
  }
  std::vector<BondRun> runs;
  for (Index first = 0, last = 0; first < count; first = last) {
    last = first + 1;
    while (last < count && continues[last]) ++last;
    // Differences might add up along a run.
    const bool is_run = last - first >= least_run && are_alike(points, bonds, first, last - 1);
    if (is_run) runs.push_back({first, last});
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
