#include "src/connectivity/free_motion.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "src/connectivity/pieces.hpp"
#include "src/connectivity/rigid_motions.hpp"
#include "src/measures/small_algebra.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

Components connected_components(const Bonds& bonds, std::span<const char> broken,
                                std::span<const BondEnds> links) {
  std::vector<Index> parent(bonds.points());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  /// @return the root of both
  const auto join = [&](Index root_of_i, Index j) {
    if (parent[j] == root_of_i) return root_of_i;
    const Index b = root(j), joined = std::min(root_of_i, b);
    parent[std::max(root_of_i, b)] = joined;
    return joined;
  };
  for (Index i = 0; i < bonds.points(); ++i) {
    Index top = root(i);
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (broken.empty() || !broken[bond]) top = join(top, bonds.partner(i, bond));
    }
  }
  for (const auto& [i, j] : links) join(root(i), j);
  Components components;
  components.of_point.resize(parent.size());
  for (Index i = 0; i < bonds.points(); ++i) {
    const Index top = root(i);
    if (top == i) {
      components.of_point[i] = static_cast<Index>(components.size.size());
      components.size.push_back(0);
    } else {
      components.of_point[i] = components.of_point[top];
    }
    ++components.size[components.of_point[i]];
  }
  return components;
}

std::vector<std::vector<Index>> Components::members() const {
  std::vector<std::vector<Index>> result(size.size());
  for (std::size_t k = 0; k < size.size(); ++k) result[k].reserve(size[k]);
  for (std::size_t i = 0; i < of_point.size(); ++i) {
    result[of_point[i]].push_back(static_cast<Index>(i));
  }
  return result;
}

namespace {

/// Adds the link of an image to its source, and the motions that would part it from where its
/// source takes it: m(X') - mirror m(X) = 0 must hold, except where the jump over a period is free.
void tie(const Points& points, Index image, std::span<const double> positions, Holding& holding) {
  const ImageKind& kind = points.image_kind(image);
  const Index source = points.source(image);
  const std::size_t d = std::size_t(points.dimension);
  const auto place = [&](Index i) {
    Coordinates at{};
    for (std::size_t c = 0; c < d; ++c) at[c] = positions[std::size_t(i) * d + c];
    return at;
  };
  for (std::size_t c = 0; c < d; ++c) {
    bool is_free = false;
    for (std::size_t axis = 0; axis < d; ++axis) {
      is_free |= kind.periods[axis] != 0 && holding.free_jump[axis][c];
    }
    if (is_free) continue;
    Coordinates along{}, axis{};
    along[c] = 1.0 - kind.mirror[c];
    axis[c] = 1.0;
    const Coordinates of_image = cross(place(image), axis), of_source = cross(place(source), axis);
    holding.motions.push_back(
        {source, along, minus<3>(of_image, scaled<3>(kind.mirror[c], of_source))});
  }
  holding.links.push_back({source, image});
}

}  // namespace

Holding with_images(Holding holding, const Points& points, const Bonds& bonds,
                    std::span<const char> broken, std::span<const double> positions) {
  std::vector<char> is_bonded(std::size_t(points.count()), 0);
  for (Index i = 0; i < points.own(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (broken.empty() || !broken[bond]) is_bonded[std::size_t(bonds.partner(i, bond))] = 1;
    }
  }
  for (Index image = points.own(); image < points.count(); ++image) {
    if (is_bonded[std::size_t(image)]) tie(points, image, positions, holding);
  }
  return holding;
}

namespace {

/// Gathers the free motions found by all ranks, at all of them.
std::vector<std::pair<FreeMotion, RigidMotions>> of_all_ranks(
    const std::vector<std::pair<FreeMotion, RigidMotions>>& mine, int dimension,
    const Communicator& ranks) {
  const std::size_t modes = std::size_t(dimension) * std::size_t(dimension + 1) / 2;
  std::vector<double> flat;
  for (const auto& [piece, motions] : mine) {
    flat.insert(flat.end(), {double(piece.points), double(piece.example)});
    flat.insert(flat.end(), piece.place.begin(), piece.place.end());
    flat.push_back(double(motions.count));
    flat.insert(flat.end(), motions.basis.begin(), motions.basis.end());
  }
  flat = concatenated(ranks, flat);
  std::vector<std::pair<FreeMotion, RigidMotions>> all;
  for (auto next = flat.begin(); next != flat.end();) {
    auto& [piece, motions] = all.emplace_back();
    piece.points = GlobalIndex(next[0]);
    piece.example = GlobalIndex(next[1]);
    std::copy_n(next + 2, 3, piece.place.begin());
    motions.dimension = dimension;
    motions.count = int(next[5]);
    const auto basis = next + 6;
    next = basis + std::ptrdiff_t(std::size_t(motions.count) * modes);
    motions.basis.assign(basis, next);
  }
  return all;
}

}  // namespace

std::vector<FreeMotion> free_motions(const Points& points, const Bonds& bonds,
                                     const Holding& of_body, const IndexMap& index_map) {
  const Holding holding = with_images(of_body, points, bonds, {}, points.reference);
  const std::vector<Piece> pieces =
      pieces_of(points, bonds, {}, holding.links, holding.ties, index_map);
  const std::vector<RigidMotions> motions =
      FreePieces(points, points.reference, holding, index_map).motions(pieces);
  std::vector<std::pair<FreeMotion, RigidMotions>> found;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const Piece& piece = pieces[k];
    if (motions[k].count == 0 || piece.members.empty()) continue;
    const Index first = piece.members.front();
    if (index_map.number_of(first) != piece.lowest) continue;
    found.push_back({{piece.points, piece.lowest, points.position(first), {}}, motions[k]});
  }
  found = of_all_ranks(found, points.dimension, index_map.ranks());
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::pair(-a.first.points, a.first.example) <
           std::pair(-b.first.points, b.first.example);
  });
  std::vector<FreeMotion> result;
  for (auto& [piece, free] : found) {
    piece.motions = motion_names(free);
    result.push_back(std::move(piece));
  }
  return result;
}

}  // namespace peristat
