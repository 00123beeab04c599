#include "src/neighbourhood/bond_runs.hpp"

#include <algorithm>
#include <tuple>

#include "src/core/lanes.hpp"

namespace peristat {
namespace {

bool is_bonded_to_next(const Bonds& bonds, Index i) {
  const PartnersOfPoint partners = bonds.of(i);
  return !partners.empty() && partners[0] == i + 1;
}

struct FoundRun : BondRun {
  bool has_one_kind = true;
  std::uint16_t* numbers = nullptr;  // of kinds, to be written
};

/// All maximal runs of these points, as long as they may be, in the order of their first bonds.
/// @param own points before ghosts and images, which are no partners of runs
std::vector<FoundRun> runs_between(const Bonds& bonds, const BondKinds& kinds, Index first,
                                   Index last, Index own) {
  std::vector<FoundRun> found;
  std::vector<std::size_t> open, opened;  // runs of the point before and of this one, by `ahead`
  for (Index i = first; i < last; ++i, open.swap(opened)) {
    opened.clear();
    auto candidate = open.begin();
    const Offset first_bond = bonds.offset[i];
    for (Offset bond = first_bond; bond < bonds.offset[i + 1]; ++bond) {
      const Index partner = bonds.partner(i, bond), ahead = partner - i;
      if (partner >= own) break;
      while (candidate != open.end() && found[*candidate].ahead < ahead) ++candidate;
      const bool is_next = candidate != open.end() && found[*candidate].ahead == ahead;
      const bool is_alike = is_next && kinds[found[*candidate].first_bond(bonds)] == kinds[bond];
      if (is_alike || (is_next && kinds.are_numbered())) {
        opened.push_back(*candidate);
        ++found[*candidate].points;
        found[*candidate].has_one_kind &= is_alike;
      } else {
        opened.push_back(found.size());
        found.push_back({{i, 1, ahead, Index(bond - first_bond)}});
      }
    }
  }
  return found;
}

/// The runs that are long enough, after others of several kinds are cut into pieces of one.
std::vector<FoundRun> long_ones(const std::vector<FoundRun>& runs, const Bonds& bonds,
                                const BondKinds& kinds) {
  std::vector<FoundRun> kept;
  const auto keep = [&](const FoundRun& run) {
    if (run.points >= BondRuns::shortest) kept.push_back(run);
  };
  for (const FoundRun& run : runs) {
    if (run.has_one_kind || run.points >= BondRuns::shortest_of_several) {
      keep(run);
      continue;
    }
    FoundRun piece = run;
    piece.has_one_kind = true;
    piece.points = 1;
    for (Index i = run.first + 1; i < run.last(); ++i) {
      const Offset bond = *bonds.find(i, i + run.ahead);
      if (kinds[bond] == kinds[piece.first_bond(bonds)]) {
        ++piece.points;
      } else {
        keep(piece);
        piece.first = i;
        piece.points = 1;
        piece.place = Index(bond - bonds.offset[i]);
      }
    }
    keep(piece);
  }
  return kept;
}

/// Room for the numbers of the kinds of the runs that have several.
std::vector<std::uint16_t> room_for_kinds(std::vector<FoundRun>& runs) {
  const auto padded = [](const FoundRun& run) {
    constexpr Index batch = SingleLanes::count;  // the longest
    return run.has_one_kind ? 0 : (run.points + batch - 1) / batch * batch;
  };
  std::size_t size = 0;
  for (const FoundRun& run : runs) size += std::size_t(padded(run));
  std::vector<std::uint16_t> room(size, 0);
  std::uint16_t* next = room.data();
  for (FoundRun& run : runs) {
    if (!run.has_one_kind) run.kinds = run.numbers = next;
    next += padded(run);
  }
  return room;
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
  ends_.shrink_to_fit();
  runs_.shrink_to_fit();
  loose_.shrink_to_fit();
}

void BondRuns::add_group(const Points& points, const Bonds& bonds, const BondKinds& kinds,
                         Index first, Index last) {
  const Index own = points.own_rows();
  std::vector<FoundRun> runs =
      long_ones(runs_between(bonds, kinds, first, last, own), bonds, kinds);
  std::ranges::sort(runs, {}, [](const BondRun& run) { return std::tuple(run.ahead, run.first); });
  std::vector<std::uint16_t> room = room_for_kinds(runs);
  if (!room.empty()) kinds_.push_back(std::move(room));
  const std::size_t runs_before = runs_.size(), before = loose_.size();
  runs_.insert(runs_.end(), runs.begin(), runs.end());
  for_each_bond(
      {first, last, std::span(runs_).subspan(runs_before), {}}, bonds,
      [&](std::size_t r, Index i, Offset bond) {
        if (runs[r].numbers) runs[r].numbers[i - runs[r].first] = kinds.number(bond);
      },
      [&](Index i, Offset bond) {
        const bool goes_on =
            loose_.size() > before && loose_.back().point == i && loose_.back().last == bond;
        if (goes_on) {
          ++loose_.back().last;
        } else {
          loose_.push_back({i, bond, bond + 1});
        }
      });
  ends_.push_back({last, runs_.size(), loose_.size()});
}

BondRuns::Group BondRuns::group(std::size_t number) const {
  const End before = number > 0 ? ends_[number - 1] : End{first_, 0, 0}, end = ends_[number];
  return {before.last, end.last, std::span(runs_).subspan(before.runs, end.runs - before.runs),
          std::span(loose_).subspan(before.loose, end.loose - before.loose)};
}

Offset BondRuns::bonds_in_runs() const {
  Offset bonds = 0;
  for (const BondRun& run : runs_) bonds += run.points;
  return bonds;
}

double share_in_runs(const Points& points, const Bonds& bonds, int threads) {
  const auto count = std::ptrdiff_t(bonds.points());
  double inside = 0.0;
#pragma omp parallel for num_threads(threads) reduction(+ : inside)
  for (int part = 0; part < threads; ++part) {
    const BondRuns runs(points, bonds, bonds.kind, Index(count * part / threads),
                        Index(count * (part + 1) / threads));
    inside += double(runs.bonds_in_runs());
  }
  return bonds.count() > 0 ? inside / double(bonds.count()) : 0.0;
}

}  // namespace peristat
