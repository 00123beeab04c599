#include "src/neighbourhood/bond_runs.hpp"

#include <algorithm>
#include <tuple>

namespace peristat {
namespace {

bool is_bonded_to_next(const Bonds& bonds, Index i) {
  return bonds.offset[i] < bonds.offset[i + 1] && bonds.partner[bonds.offset[i]] == i + 1;
}

/// All maximal runs of these points, as long as they may be, in the order of their first bonds.
/// @param ghosts the first of them: points from it on are no partners of runs
std::vector<BondRun> runs_between(const Bonds& bonds, const BondKinds& kinds, Index first,
                                  Index last, Index ghosts) {
  std::vector<BondRun> found;
  std::vector<std::size_t> open, opened;  // runs of the point before and of this one, by `ahead`
  for (Index i = first; i < last; ++i, open.swap(opened)) {
    opened.clear();
    auto candidate = open.begin();
    const Offset first_bond = bonds.offset[i];
    for (Offset bond = first_bond; bond < bonds.offset[i + 1]; ++bond) {
      const Index partner = bonds.partner[bond], ahead = partner - i;
      if (partner >= ghosts) break;
      while (candidate != open.end() && found[*candidate].ahead < ahead) ++candidate;
      const bool goes_on = candidate != open.end() && found[*candidate].ahead == ahead &&
                           kinds[found[*candidate].first_bond(bonds)] == kinds[bond];
      if (goes_on) {
        opened.push_back(*candidate);
        ++found[*candidate].points;
      } else {
        opened.push_back(found.size());
        found.push_back({i, 1, ahead, Index(bond - first_bond)});
      }
    }
  }
  return found;
}

}  // namespace

BondRuns::BondRuns(const Points& points, const Bonds& bonds, const BondKinds& kinds, Index first,
                   Index last)
    : first_(first) {
  while (first < last) {
    Index row = first + 1;
    while (row < last && is_bonded_to_next(bonds, row - 1)) ++row;
    const Index parts = (row - first + longest - 1) / longest;
    for (Index part = parts; part > 0; --part) {
      const Index end = first + (row - first + part - 1) / part;
      add_group(points, bonds, kinds, first, end);
      first = end;
    }
  }
}

void BondRuns::add_group(const Points& points, const Bonds& bonds, const BondKinds& kinds,
                         Index first, Index last) {
  std::vector<BondRun> runs =
      runs_between(bonds, kinds, first, last, points.owned.value_or(points.count()));
  std::erase_if(runs, [](const BondRun& run) { return run.points < shortest; });
  std::ranges::sort(runs, {}, [](const BondRun& run) { return std::tuple(run.ahead, run.first); });
  const std::size_t before = loose_.size();
  for_each_bond(
      {first, last, runs, {}}, bonds, [](std::size_t, Index, Offset) {},
      [&](Index i, Offset bond) {
        const bool goes_on =
            loose_.size() > before && loose_.back().point == i && loose_.back().last == bond;
        if (goes_on) {
          ++loose_.back().last;
        } else {
          loose_.push_back({i, bond, bond + 1});
        }
      });
  runs_.insert(runs_.end(), runs.begin(), runs.end());
  ends_.push_back({last, runs_.size(), loose_.size()});
}

BondRuns::Group BondRuns::group(std::size_t number) const {
  const End before = number > 0 ? ends_[number - 1] : End{first_, 0, 0}, end = ends_[number];
  return {before.last, end.last, std::span(runs_).subspan(before.runs, end.runs - before.runs),
          std::span(loose_).subspan(before.loose, end.loose - before.loose)};
}

double share_in_runs(const Points& points, const Bonds& bonds, int threads) {
  const auto count = std::ptrdiff_t(bonds.points());
  double inside = 0.0;
#pragma omp parallel for num_threads(threads) reduction(+ : inside)
  for (int part = 0; part < threads; ++part) {
    const BondRuns runs(points, bonds, bonds.kind, Index(count * part / threads),
                        Index(count * (part + 1) / threads));
    for (const BondRun& run : runs.runs()) inside += double(run.points);
  }
  return bonds.count() > 0 ? inside / double(bonds.count()) : 0.0;
}

}  // namespace peristat
