#include "src/connectivity/free_motion.hpp"

#include <algorithm>
#include <numeric>

#include "src/connectivity/rigid_motions.hpp"

namespace peristat {

Components connected_components(const Bonds& bonds, std::span<const char> broken) {
  std::vector<Index> parent(bonds.points());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (!broken.empty() && broken[bond]) continue;
      const Index a = root(i), b = root(bonds.partner[bond]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
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

std::vector<FreeMotion> free_motions(const Points& points, const Bonds& bonds,
                                     const std::vector<char>& prescribed) {
  std::vector<FreeMotion> result;
  for (const std::vector<Index>& component : connected_components(bonds).members()) {
    const RigidMotions free = free_rigid_motions(points.dimension, points.reference, component,
                                                 prescribed, points.spacing);
    if (free.count == 0) continue;
    result.push_back({static_cast<Index>(component.size()), component.front(), motion_names(free)});
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const FreeMotion& a, const FreeMotion& b) { return a.points > b.points; });
  return result;
}

}  // namespace peristat
