#include "assembly/workspace.hpp"

#include <memory>

namespace peristat {

Workspace::Workspace(const Points& of, const Model& with, int threads)
    : points(of),
      model(with),
      ranges(partition_rows(Pattern(with.bonds), threads)),
      rows(std::size_t(of.count()) * row_width(of.dimension)),
      sums(ranges.size()),
      stored(ranges.size()),
      longest(ranges.size(), -1.0) {
  for (std::size_t t = 0; t < ranges.size(); ++t) {
    sums[t].resize(std::size_t(ranges[t].reach - ranges[t].first) * block_width(of.dimension));
  }
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

}  // namespace peristat
