#include "assembly/workspace.hpp"

#include "src/lanes.hpp"

namespace peristat {

Workspace::Workspace(const Points& of, const Model& with, int threads)
    : points(of),
      model(with),
      potential(with.potential),
      ranges(partition_rows(Pattern(with.bonds), threads)),
      rows(std::size_t(of.count()) * row_width(of.dimension)),
      sums(ranges.size()),
      stored(ranges.size()),
      longest(ranges.size(), -1.0) {
  for (std::size_t t = 0; t < ranges.size(); ++t) {
    sums[t].resize(std::size_t(ranges[t].reach - ranges[t].first) * block_width(of.dimension));
  }
  std::visit(
      [&]<class P>(const P&) {
        if constexpr (PotentialWithHistory<P>) {
          largest_stretch.resize(std::size_t(with.bonds.count()) + lane_count, 0.0);
          for (std::size_t b = 0; b < with.never_fails.size(); ++b) {
            if (with.never_fails[b]) largest_stretch[b] = P::never_fails;
          }
        }
      },
      with.potential);
  if (with.has_only_bonds()) return;
  blocks.resize(ranges.size());
  for (std::size_t t = 0; t < ranges.size(); ++t) {
    const Offset beyond = with.bonds.offset[ranges[t].reach] - with.bonds.offset[ranges[t].last];
    blocks[t].resize(std::size_t(beyond) * of.dimension * of.dimension);
  }
  const auto make_local = [&](auto dimension) {
    std::vector<std::unique_ptr<LocalWorkspace<decltype(dimension)::value>>> made;
    for (std::size_t t = 0; t < ranges.size(); ++t) {
      made.push_back(std::make_unique<LocalWorkspace<decltype(dimension)::value>>(of, with.bonds));
    }
    local = std::move(made);
  };
  if (of.dimension == 2) make_local(std::integral_constant<int, 2>{});
  if (of.dimension == 3) make_local(std::integral_constant<int, 3>{});
}

void Workspace::find_integrity() {
  if (largest_stretch.empty() || model.has_only_bonds()) return;
  const Bonds& bonds = model.bonds;
  integrity.resize(std::size_t(bonds.count()));
  degraded_points.assign(std::size_t(bonds.points()), 0);
  std::visit(
      [&]<class P>(const P& law) {
        if constexpr (PotentialWithHistory<P>) {
          for (Index i = 0; i < bonds.points(); ++i) {
            for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
              integrity[bond] = law.integrity_after(largest_stretch[bond]);
              if (integrity[bond] == 1.0) continue;
              degraded_points[i] = degraded_points[bonds.partner[bond]] = 1;
            }
          }
        }
      },
      model.potential);
}

}  // namespace peristat
