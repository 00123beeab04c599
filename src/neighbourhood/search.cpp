#include "src/neighbourhood/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "src/neighbourhood/horizon.hpp"

namespace peristat {
namespace {

/// Cells per search radius. Half the radius leaves 3.7 candidates per bond in 3D instead of 6.1
/// with cells as large as the radius.
constexpr int cells_per_radius = 2;

/// Some points in cells of at least radius / cells_per_radius; the last direction is the fastest.
/// Points of a cell are contiguous, in the order of `members`.
template <int D>
struct CellList {
  std::array<double, D> lower{};
  std::array<double, D> cells_per_length{};
  std::array<int, D> extent{};
  std::vector<Index> begin;                     // first place of each cell, cells + 1
  std::vector<Index> point;                     // points in the order of their cells
  std::vector<std::array<double, D>> position;  // their positions in this order

  CellList(const Points& points, const std::vector<Index>& members, double radius) {
    std::array<double, D> upper;
    lower.fill(std::numeric_limits<double>::infinity());
    upper.fill(-std::numeric_limits<double>::infinity());
    const auto count = static_cast<Index>(members.size());
    const double* reference = points.reference.data();
    for (const Index i : members) {
      for (int c = 0; c < D; ++c) {
        lower[c] = std::min(lower[c], reference[std::size_t(i) * D + c]);
        upper[c] = std::max(upper[c], reference[std::size_t(i) * D + c]);
      }
    }
    // Many more cells than points would only cost memory: a cloud with far outliers gets larger
    // ones.
    const double most_cells = 8.0 * count + 64.0;
    std::array<double, D> wanted;
    for (int c = 0; c < D; ++c) {
      const double cells_along =
          (upper[c] - lower[c]) * cells_per_radius / inclusive_radius(radius);
      wanted[c] = std::clamp(std::floor(cells_along), 1.0, most_cells);
    }
    const auto total = [&] {
      return std::accumulate(wanted.begin(), wanted.end(), 1.0, std::multiplies<>());
    };
    while (total() > most_cells) {
      double& largest = *std::max_element(wanted.begin(), wanted.end());
      largest = std::ceil(0.5 * largest);
    }
    const std::size_t cells = std::size_t(total());
    for (int c = 0; c < D; ++c) {
      const double span = upper[c] - lower[c];
      extent[c] = static_cast<int>(wanted[c]);
      cells_per_length[c] = span > 0.0 ? extent[c] / span : 0.0;
    }
    std::vector<Index> cell(members.size());
    begin.assign(cells + 1, 0);
    for (Index k = 0; k < count; ++k) {
      std::size_t flat = 0;
      for (int c = 0; c < D; ++c) {
        flat = flat * extent[c] + coordinate(reference[std::size_t(members[k]) * D + c], c);
      }
      cell[k] = static_cast<Index>(flat);
      ++begin[flat + 1];
    }
    for (std::size_t k = 0; k < cells; ++k) begin[k + 1] += begin[k];
    std::vector<Index> next(begin.begin(), begin.end() - 1);
    point.resize(count);
    position.resize(count);
    for (Index k = 0; k < count; ++k) {
      const Index place = next[cell[k]]++;
      point[place] = members[k];
      for (int c = 0; c < D; ++c) position[place][c] = reference[std::size_t(members[k]) * D + c];
    }
  }

  [[nodiscard]] int coordinate(double at, int direction) const {
    // Clamped before the conversion: a body whose thickness is round-off has huge numbers here.
    const double cell = (at - lower[direction]) * cells_per_length[direction];
    return static_cast<int>(std::clamp(cell, 0.0, extent[direction] - 1.0));
  }

  /// Calls visit(first, last) for the places of each run of cells along the fastest direction.
  template <class Visit>
  void for_each_run(const std::array<double, D>& at, double radius, const Visit& visit) const {
    std::array<int, D> from, to;
    for (int c = 0; c < D; ++c) {
      from[c] = coordinate(at[c] - radius, c);
      to[c] = coordinate(at[c] + radius, c);
    }
    if constexpr (D == 1) {
      visit(begin[from[0]], begin[to[0] + 1]);
    } else if constexpr (D == 2) {
      for (int a = from[0]; a <= to[0]; ++a) {
        const std::size_t row = std::size_t(a) * extent[1];
        visit(begin[row + from[1]], begin[row + to[1] + 1]);
      }
    } else {
      for (int a = from[0]; a <= to[0]; ++a) {
        for (int b = from[1]; b <= to[1]; ++b) {
          const std::size_t row = (std::size_t(a) * extent[1] + b) * extent[2];
          visit(begin[row + from[2]], begin[row + to[2] + 1]);
        }
      }
    }
  }
};

/// Rows that are searched together. Their number does not depend on the number of threads, so that
/// kinds of bonds do not, either.
constexpr Index rows_per_part = 8192;

/// Bonds of a part's rows.
struct Found {
  std::vector<Index> partner;
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
    std::vector<Candidate> row;
    for (Index i = first; i < last; ++i) {
      const std::size_t kept = find_row(i, row);
      std::sort(row.begin(), row.begin() + std::ptrdiff_t(kept),
                [](const Candidate& a, const Candidate& b) { return a.partner < b.partner; });
      for (std::size_t k = 0; k < kept; ++k) {
        mine.partner.push_back(row[k].partner);
        mine.kind.push_back({1.0 / std::sqrt(row[k].squared), 0.0});
      }
      bonds.offset[std::size_t(i) + 1] = static_cast<Offset>(kept);
    }
  }

  for (Index i = 0; i < count; ++i) bonds.offset[std::size_t(i) + 1] += bonds.offset[i];
  bonds.partner.resize(std::size_t(bonds.offset[count]));
  bonds.kind.reserve(bonds.partner.size());
  std::size_t at = 0;
  for (Found& part : found) {
    std::copy(part.partner.begin(), part.partner.end(), bonds.partner.begin() + std::ptrdiff_t(at));
    bonds.kind.append(part.kind);
    at += part.partner.size();
    part = {};
  }
  return bonds;
}

template <int D>
Bonds search(const Points& points, double radius, int threads) {
  const CellList<D> cells(points, all_of(points), radius);
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
      : largest(largest_of(members, radii)), cells(points, members, largest) {
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
  const CellList<D> cells(points, all_of(points), radius);
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
