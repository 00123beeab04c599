#include "src/connectivity/free_motion.hpp"

#include <algorithm>
#include <numeric>

#include "src/connectivity/rigid_motions.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {

Components connected_components(const Bonds& bonds, std::span<const char> broken,
                                std::span<const BondEnds> links) {
  std::vector<Index> parent(bonds.points());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const auto join = [&](Index i, Index j) {
    const Index a = root(i), b = root(j);
    parent[std::max(a, b)] = std::min(a, b);
  };
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (broken.empty() || !broken[bond]) join(i, bonds.partner[bond]);
    }
  }
  for (const auto& [i, j] : links) join(i, j);
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

/// Motions of a piece that would part an image from where its source takes it: m(X') - mirror m(X),
/// but where the jump over a period is free.
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
      if (broken.empty() || !broken[bond]) is_bonded[std::size_t(bonds.partner[bond])] = 1;
    }
  }
  for (Index image = points.own(); image < points.count(); ++image) {
    if (is_bonded[std::size_t(image)]) tie(points, image, positions, holding);
  }
  return holding;
}

std::vector<FreeMotion> free_motions(const Points& points, const Bonds& bonds,
                                     const Holding& of_body) {
  const Holding holding = with_images(of_body, points, bonds, {}, points.reference);
  std::vector<FreeMotion> result;
  for (const std::vector<Index>& component :
       connected_components(bonds, {}, holding.links).members()) {
    if (points.is_image(component.front())) continue;  // beyond reach of the body
    const RigidMotions free =
        free_rigid_motions(points.dimension, points.reference, component, holding.prescribed,
                           points.spacing, holding.motions);
    if (free.count == 0) continue;
    const auto own = std::lower_bound(component.begin(), component.end(), points.own());
    result.push_back(
        {static_cast<Index>(own - component.begin()), component.front(), motion_names(free)});
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const FreeMotion& a, const FreeMotion& b) { return a.points > b.points; });
  return result;
}

}  // namespace peristat
