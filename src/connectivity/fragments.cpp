#include "src/connectivity/fragments.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "src/connectivity/free_motion.hpp"
#include "src/connectivity/loose_points.hpp"
#include "src/connectivity/pieces.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Numbers the floating pieces in the order of Fragments::piece.
void number_pieces(const std::vector<Piece>& pieces, const std::vector<RigidMotions>& free,
                   const Points& points, const IndexMap& index_map, Fragments& fragments) {
  std::vector<const Piece*> floating;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (free[k].count > 0) floating.push_back(&pieces[k]);
  }
  using Rank = std::pair<double, double>;  // the largest first
  const auto rank_of = [](const Piece& piece) {
    return Rank(-double(piece.points), double(piece.lowest));
  };
  std::vector<Rank> order;
  for (const Piece* piece : floating) order.push_back(rank_of(*piece));
  std::vector<double> flat;
  for (const Rank& rank : order) flat.insert(flat.end(), {rank.first, rank.second});
  flat = concatenated(index_map.ranks(), flat);
  order.clear();
  for (std::size_t k = 0; k < flat.size(); k += 2) order.emplace_back(flat[k], flat[k + 1]);
  std::sort(order.begin(), order.end());
  order.erase(std::unique(order.begin(), order.end()), order.end());
  fragments.piece.assign(std::size_t(points.count()), 0);
  fragments.count = static_cast<int>(order.size());
  for (const Piece* piece : floating) {
    const auto at = std::lower_bound(order.begin(), order.end(), rank_of(*piece));
    for (Index i : piece->members) {
      fragments.piece[i] = static_cast<std::int32_t>(at - order.begin()) + 1;
    }
  }
}

/// Pieces of the points that are not loose.
std::vector<Piece> cores_of(const Web& web, const Points& points, const Bonds& bonds,
                            const std::vector<char>& is_loose, const Holding& holding,
                            const IndexMap& index_map) {
  std::vector<char> apart(std::size_t(bonds.count()), 1);
  web.for_each_bond(
      [&](Index i, Index j, Offset bond) { apart[bond] = is_loose[i] || is_loose[j]; });
  std::vector<BondEnds> of_cores;
  for (const auto& [i, j] : holding.links) {
    if (!is_loose[i] && !is_loose[j]) of_cores.push_back({i, j});
  }
  std::vector<Index> ties = holding.ties;
  for (Index& point : ties) {
    if (point >= 0 && is_loose[std::size_t(point)]) point = -1;
  }
  std::vector<Piece> cores = pieces_of(points, bonds, apart, of_cores, ties, index_map);
  // Drops loose points: each is a piece of its own, on one rank alone.
  std::erase_if(
      cores, [&](const Piece& core) { return !core.is_shared && is_loose[core.members.front()]; });
  return cores;
}

}  // namespace

Fragments find_fragments(const Points& points, const Bonds& bonds, std::span<const char> broken,
                         const std::vector<char>& prescribed, std::span<const double> displacement,
                         const Holding& of_body, const IndexMap& index_map) {
  const int d = points.dimension;
  std::vector<double> positions = points.reference;
  for (std::size_t dof = 0; dof < positions.size(); ++dof) positions[dof] += displacement[dof];
  Web web(bonds, broken, d, std::move(positions));

  const Holding holding = with_images(of_body, points, bonds, broken, web.positions());
  std::vector<char> held = prescribed;  // springs of a foundation hold, too
  for (std::size_t dof = 0; dof < holding.prescribed.size(); ++dof) {
    held[dof] |= holding.prescribed[dof];
  }
  Fragments fragments;
  fragments.pinned.assign(prescribed.size(), 0);
  const FreePieces free(points, web.positions(), holding, index_map);
  std::vector<Piece> cores =
      pieces_of(points, bonds, broken, holding.links, holding.ties, index_map);
  std::vector<RigidMotions> motions = free.motions(cores);
  number_pieces(cores, motions, points, index_map, fragments);

  const Index own = std::min(index_map.owned(), points.count());
  if (any_of_all(index_map.ranks(), !hold_all(web, own, held, holding.handles))) {
    std::vector<Support> support = supports_of(web, points.count(), held, holding.handles);
    const std::vector<char> is_loose = strip_loose_points(web, support, index_map);
    for (Index i = 0; i < own; ++i) {
      if (is_loose[i]) fragments.loose.push_back(i);
    }
    pin_loose_points(web, fragments.loose, holding.handles, std::move(support), index_map,
                     fragments.pinned);
    cores = cores_of(web, points, bonds, is_loose, holding, index_map);
    motions = free.motions(cores);
  }
  free.pin(cores, motions, held, fragments.pinned);
  return fragments;
}

}  // namespace peristat
