#include "assembly/terms/states/state_network.hpp"

#include <algorithm>

#include "src/core/threads.hpp"
#include "src/geometry/gather_images.hpp"
#include "src/neighbourhood/alike_bonds.hpp"

namespace peristat {
namespace {

double squared_length(const Points& points, Index i, Index j) {
  const auto d = std::size_t(points.dimension);
  double squared = 0.0;
  for (std::size_t c = 0; c < d; ++c) {
    const double along =
        points.reference[std::size_t(j) * d + c] - points.reference[std::size_t(i) * d + c];
    squared += along * along;
  }
  return squared;
}

/// Marks points once per row without clearing in between.
class Marks {
 public:
  explicit Marks(Index points) : row_(std::size_t(points), -1) {}
  /// Whether the point is met for the first time in this row.
  bool meet(Index point, Index row) {
    if (row_[std::size_t(point)] == row) return false;
    row_[std::size_t(point)] = row;
    return true;
  }

 private:
  std::vector<Index> row_;
};

}  // namespace

std::vector<double> moments_of(const Points& points, const Bonds& bonds) {
  std::vector<double> moment(points.volume.size(), 0.0);
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner(i, bond);
      const double part =
          bonds.weight(bond) * bonds.inverse_length(bond) * squared_length(points, i, j);
      moment[std::size_t(i)] += part;
      moment[std::size_t(j)] += part;
    }
  }
  gather_images(points, moment);
  return moment;
}

std::vector<BondTwin> twins_of(const Points& points, const Bonds& bonds) {
  if (points.own() == points.count()) return {};
  const AlikeBonds alike(points, bonds);
  std::vector<BondTwin> twins(std::size_t(bonds.count()));
  for (Index i = 0; i < points.own(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner(i, bond);
      if (!points.is_image(j)) continue;
      twins[std::size_t(bond)] = {points.source(j), bond};
      alike.for_each(bond, [&](Offset other) {
        if (other != bond) twins[std::size_t(bond)].bond = other;
      });
    }
  }
  return twins;
}

StateNetwork::StateNetwork(const Bonds& bonds, bool reaches_twice, int threads)
    : LowerNeighbours(bonds) {
  const Index points = bonds.points();
  if (!reaches_twice) {
    block_offset = bonds.offset;
    partner = bonds.partner;
    return;
  }
  // Counted first and then written, so that no more is allocated than is kept.
  const auto for_rows = [&](const auto& row) {
    run_on_threads(threads, [&](int thread) {
      Marks marks(points);
      const Index first = Index(std::int64_t(points) * thread / threads);
      const Index last = Index(std::int64_t(points) * (thread + 1) / threads);
      for (Index i = first; i < last; ++i) {
        const auto meet = [&](Index j) {
          if (j > i && marks.meet(j, i)) row(i, j);
        };
        const auto meet_neighbours_of = [&](Index centre) {
          meet(centre);
          for_each_neighbour(bonds, centre, [&](Index j, Offset) { meet(j); });
        };
        meet_neighbours_of(i);
        for_each_neighbour(bonds, i, [&](Index j, Offset) { meet_neighbours_of(j); });
      }
    });
  };
  block_offset.assign(std::size_t(points) + 1, 0);
  for_rows([&](Index i, Index) { ++block_offset[std::size_t(i) + 1]; });
  for (Index i = 0; i < points; ++i) block_offset[i + 1] += block_offset[i];
  std::vector<Index> upper(std::size_t(block_offset.back()));
  std::vector<Offset> next(block_offset.begin(), block_offset.end() - 1);
  for_rows([&](Index i, Index j) { upper[std::size_t(next[i]++)] = j; });
  for (Index i = 0; i < points; ++i) {
    std::sort(upper.begin() + block_offset[i], upper.begin() + block_offset[i + 1]);
  }
  partner = Partners(block_offset, upper);
}

}  // namespace peristat
