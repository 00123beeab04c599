#include "src/neighbourhood/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <ranges>
#include <span>

#include "src/neighbourhood/cell_list.hpp"
#include "src/neighbourhood/horizon.hpp"

namespace peristat {
namespace {

/// Rows that are searched together. Their number does not depend on the number of threads, so that
/// kinds of bonds do not, either.
constexpr Index rows_per_part = 8192;

/// Bonds of a part's rows.
struct Found {
  Partners partner;
  BondKinds kind;
};

struct Candidate {
  Index partner;
  double squared;
};

std::vector<Index> all_of(const Points& points) {
  std::vector<Index> all(points.volume.size());
  std::iota(all.begin(), all.end(), Index(0));
  return all;
}

template <int D>
std::array<double, D> place_of(const Points& points, Index i) {
  std::array<double, D> at;
  for (int c = 0; c < D; ++c) at[c] = points.reference[std::size_t(i) * D + c];
  return at;
}

/// Adds the points above `i` that are near it to the first `kept` candidates of its row; returns
/// how many there are then.
/// @param is_near of a place in the list and its squared distance
template <int D, class IsNear>
std::size_t scan(const CellList<D>& cells, const std::array<double, D>& at, Index i, double radius,
                 std::vector<Candidate>& row, std::size_t kept, const IsNear& is_near) {
  cells.for_each_run(at, radius, [&](Index begin, Index end) {
    if (row.size() < kept + std::size_t(end - begin)) row.resize(kept + std::size_t(end - begin));
    for (Index place = begin; place < end; ++place) {
      double squared = 0.0;
      for (int c = 0; c < D; ++c) {
        const double step = cells.position[place][c] - at[c];
        squared += step * step;
      }
      row[kept] = {cells.point[place], squared};
      kept += std::size_t(is_near(place, squared) & (cells.point[place] > i));
    }
  });
  return kept;
}

/// Bonds of all rows.
/// @param find_row puts the partners of a point in front of a row; returns how many there are
template <class FindRow>
Bonds bonds_of_rows(const Points& points, int threads, const FindRow& find_row) {
  const Index count = points.count();
  Bonds bonds;
  bonds.offset.assign(std::size_t(count) + 1, 0);
  const Index parts = (count + rows_per_part - 1) / rows_per_part;
  std::vector<Found> found(static_cast<std::size_t>(parts));

#pragma omp parallel for num_threads(threads) schedule(dynamic)
  for (Index part = 0; part < parts; ++part) {
    const Index first = part * rows_per_part;
    const Index last = std::min(count - first, rows_per_part) + first;
    Found& mine = found[std::size_t(part)];
    PartnersBuilder partners(first);
    std::vector<Candidate> row;
    for (Index i = first; i < last; ++i) {
      const std::size_t kept = find_row(i, row);
      std::sort(row.begin(), row.begin() + std::ptrdiff_t(kept),
                [](const Candidate& a, const Candidate& b) { return a.partner < b.partner; });
      const auto found_row = std::span(row).first(kept);
      partners.add(found_row | std::views::transform(&Candidate::partner));
      for (const Candidate& one : found_row) {
        mine.kind.push_back({1.0 / std::sqrt(one.squared), 0.0});
      }
      bonds.offset[std::size_t(i) + 1] = static_cast<Offset>(kept);
    }
    mine.partner = partners.take();
  }

  for (Index i = 0; i < count; ++i) bonds.offset[std::size_t(i) + 1] += bonds.offset[i];
  PartnersBuilder partners;
  std::size_t steps = 0;
  for (const Found& part : found) steps += part.partner.bytes() / sizeof(Index);
  partners.reserve(std::size_t(count), steps);
  bonds.kind.reserve(std::size_t(bonds.offset[count]));
  for (std::size_t part = 0; part < found.size(); ++part) {
    const std::size_t first = part * rows_per_part;
    const std::size_t rows = std::min(std::size_t(count) - first, std::size_t(rows_per_part));
    partners.append(found[part].partner, std::span(bonds.offset).subspan(first, rows + 1));
    bonds.kind.append(found[part].kind);
    found[part] = {};
  }
  bonds.partner = partners.take();
  return bonds;
}

template <int D>
Bonds search(const Points& points, double radius, int threads) {
  const CellList<D> cells(points.reference, all_of(points), radius);
  const double longest = inclusive_radius(radius);
  const double squared_longest = longest * longest;
  return bonds_of_rows(points, threads, [&](Index i, std::vector<Candidate>& row) {
    return scan<D>(cells, place_of<D>(points, i), i, longest, row, 0,
                   [&](Index, double squared) { return squared <= squared_longest; });
  });
}

/// Points whose radii differ by less than a factor of two.
template <int D>
struct Level {
  double largest;  // inclusive radius
  CellList<D> cells;
  std::vector<double> squared;  // inclusive radii in the order of the list

  Level(const Points& points, const std::vector<Index>& members, std::span<const double> radii)
      : largest(largest_of(members, radii)), cells(points.reference, members, largest) {
    for (const Index i : cells.point) {
      const double radius = inclusive_radius(radii[std::size_t(i)]);
      squared.push_back(radius * radius);
    }
  }

  static double largest_of(const std::vector<Index>& members, std::span<const double> radii) {
    double most = 0.0;
    for (const Index i : members) most = std::max(most, radii[std::size_t(i)]);
    return inclusive_radius(most);
  }
};

template <int D>
std::vector<Level<D>> levels_of(const Points& points, std::span<const double> radii) {
  constexpr int most_levels = 16;  // radii below 2^-15 of the largest share the last one
  std::vector<std::vector<Index>> members(most_levels);
  const std::vector<Index> all = all_of(points);
  const double largest = Level<D>::largest_of(all, radii);
  for (const Index i : all) {
    const double octaves = std::floor(std::log2(largest / radii[std::size_t(i)]));
    members[std::size_t(std::clamp(octaves, 0.0, most_levels - 1.0))].push_back(i);
  }
  std::vector<Level<D>> levels;
  for (const std::vector<Index>& of_level : members) {
    if (!of_level.empty()) levels.emplace_back(points, of_level, radii);
  }
  return levels;
}

template <int D>
Bonds search(const Points& points, std::span<const double> radii, int threads) {
  const std::vector<Level<D>> levels = levels_of<D>(points, radii);
  return bonds_of_rows(points, threads, [&](Index i, std::vector<Candidate>& row) {
    const std::array<double, D> at = place_of<D>(points, i);
    const double own = inclusive_radius(radii[std::size_t(i)]), squared_own = own * own;
    std::size_t kept = 0;
    for (const Level<D>& level : levels) {
      kept = scan<D>(level.cells, at, i, std::max(own, level.largest), row, kept,
                     [&](Index place, double squared) {
                       return squared <= std::max(squared_own, level.squared[std::size_t(place)]);
                     });
    }
    return kept;
  });
}

template <int D>
std::vector<std::int32_t> count(const Points& points, Index first, double radius, int threads) {
  const CellList<D> cells(points.reference, all_of(points), radius);
  const double longest = inclusive_radius(radius);
  const double squared_longest = longest * longest;
  std::vector<std::int32_t> neighbours(static_cast<std::size_t>(first), 0);
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1024)
  for (Index i = 0; i < first; ++i) {
    const std::array<double, D> at = place_of<D>(points, i);
    cells.for_each_run(at, longest, [&](Index begin, Index end) {
      for (Index place = begin; place < end; ++place) {
        double squared = 0.0;
        for (int c = 0; c < D; ++c) {
          const double step = cells.position[place][c] - at[c];
          squared += step * step;
        }
        neighbours[std::size_t(i)] += int((squared <= squared_longest) & (cells.point[place] != i));
      }
    });
  }
  return neighbours;
}

}  // namespace

Bonds search_bonds(const Points& points, double radius, int threads) {
  switch (points.dimension) {
    case 1:
      return search<1>(points, radius, threads);
    case 2:
      return search<2>(points, radius, threads);
    default:
      return search<3>(points, radius, threads);
  }
}

Bonds search_bonds(const Points& points, std::span<const double> radii, int threads) {
  switch (points.dimension) {
    case 1:
      return search<1>(points, radii, threads);
    case 2:
      return search<2>(points, radii, threads);
    default:
      return search<3>(points, radii, threads);
  }
}

std::vector<std::int32_t> count_neighbours(const Points& points, Index first, double radius,
                                           int threads) {
  switch (points.dimension) {
    case 1:
      return count<1>(points, first, radius, threads);
    case 2:
      return count<2>(points, first, radius, threads);
    default:
      return count<3>(points, first, radius, threads);
  }
}

}  // namespace peristat
