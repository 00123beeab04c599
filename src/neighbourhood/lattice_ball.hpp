#pragma once

#include <cmath>
#include <vector>

#include "src/core/types.hpp"
#include "src/neighbourhood/flatness.hpp"
#include "src/neighbourhood/horizon.hpp"

namespace peristat {

/// Interactions of one point of an infinite cubic lattice within its horizon.
class LatticeBall {
 public:
  LatticeBall(int dimension, double spacing, double horizon)
      : dimension_(dimension), spacing_(spacing), horizon_(horizon) {
    const int width = static_cast<int>(std::floor(inclusive_radius(horizon) / spacing));
    const int width_y = dimension > 1 ? width : 0, width_z = dimension > 2 ? width : 0;
    for (int x = -width; x <= width; ++x) {
      for (int y = -width_y; y <= width_y; ++y) {
        for (int z = -width_z; z <= width_z; ++z) {
          const Coordinates arm{spacing * x, spacing * y, spacing * z};
          const double squared = dot(arm, arm);
          if (squared > 0.0 && squared <= inclusive_radius(horizon) * inclusive_radius(horizon))
            arms_.push_back(arm);
        }
      }
    }
  }

  /// Vectors to the neighbours [m].
  [[nodiscard]] const std::vector<Coordinates>& arms() const { return arms_; }

  /// visit(b, c, area) for every unordered pair of neighbours within the horizon of each other that
  /// is not collinear with the point; area = |b x c|.
  template <class Visit>
  void for_each_pair(const Visit& visit) const {
    for (std::size_t j = 0; j < arms_.size(); ++j) {
      for (std::size_t k = j + 1; k < arms_.size(); ++k) {
        if (!are_mutual(j, k)) continue;
        const Coordinates normal = cross(arms_[j], arms_[k]);
        const double area = std::sqrt(dot(normal, normal));
        if (area > flat_measure * spacing_ * spacing_) visit(arms_[j], arms_[k], area);
      }
    }
  }

  /// visit(b, c, area) for the triangles whose lowest point is the origin: one of all translations
  /// of each.
  template <class Visit>
  void for_each_triangle(const Visit& visit) const {
    for (std::size_t j = first_above(); j < arms_.size(); ++j) {
      for (std::size_t k = j + 1; k < arms_.size(); ++k) {
        if (!are_mutual(j, k)) continue;
        const Coordinates normal = cross(arms_[j], arms_[k]);
        const double area = std::sqrt(dot(normal, normal));
        if (area > flat_measure * spacing_ * spacing_) visit(arms_[j], arms_[k], area);
      }
    }
  }

  /// visit(b, c, d, volume) for the tetrahedra whose lowest point is the origin.
  template <class Visit>
  void for_each_tetrahedron(const Visit& visit) const {
    if (dimension_ < 3) return;
    for_each_solid(first_above(), [&](std::size_t j, std::size_t k, std::size_t l, double volume) {
      visit(arms_[j], arms_[k], arms_[l], volume);
    });
  }

  /// visit(b, c, d, volume) for every unordered triplet of mutual neighbours that is not coplanar
  /// with the point; volume = |b.(c x d)|.
  template <class Visit>
  void for_each_triplet(const Visit& visit) const {
    if (dimension_ < 3) return;
    for_each_solid(0, [&](std::size_t j, std::size_t k, std::size_t l, double volume) {
      visit(arms_[j], arms_[k], arms_[l], volume);
    });
  }

 private:
  /// Arms ascend by x, y, z, so that the first half are the opposites of the second one.
  [[nodiscard]] std::size_t first_above() const { return arms_.size() / 2; }

  /// visit(j, k, l, volume) for every triplet of mutual neighbours j < k < l from the first on that
  /// is not coplanar with the point.
  template <class Visit>
  void for_each_solid(std::size_t first, const Visit& visit) const {
    const double least = flat_measure * spacing_ * spacing_ * spacing_;
    std::vector<std::size_t> common;
    for (std::size_t j = first; j < arms_.size(); ++j) {
      common.clear();
      for (std::size_t k = j + 1; k < arms_.size(); ++k) {
        if (are_mutual(j, k)) common.push_back(k);
      }
      for (std::size_t a = 0; a < common.size(); ++a) {
        const Coordinates normal = cross(arms_[j], arms_[common[a]]);
        for (std::size_t b = a + 1; b < common.size(); ++b) {
          if (!are_mutual(common[a], common[b])) continue;
          const double volume = std::abs(dot(normal, arms_[common[b]]));
          if (volume > least) visit(j, common[a], common[b], volume);
        }
      }
    }
  }

  static double dot(const Coordinates& a, const Coordinates& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  static Coordinates cross(const Coordinates& a, const Coordinates& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  [[nodiscard]] bool are_mutual(std::size_t j, std::size_t k) const {
    double squared = 0.0;
    for (int c = 0; c < 3; ++c) {
      const double difference = arms_[j][c] - arms_[k][c];
      squared += difference * difference;
    }
    return squared <= inclusive_radius(horizon_) * inclusive_radius(horizon_);
  }

  int dimension_;
  double spacing_, horizon_;
  std::vector<Coordinates> arms_;
};

}  // namespace peristat
