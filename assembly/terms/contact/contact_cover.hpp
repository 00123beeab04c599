#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "src/geometry/points.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Tells whether a rank has all that its points may touch. Points of other ranks are there as
/// ghosts, and images beyond planes of symmetry and periods are there, only within some distance in
/// the reference. All calls are collective, and all ranks get the same answers, which depend on the
/// states alone and not on earlier ones.
class ContactCover {
 public:
  /// @param points, index_map outlive it
  /// @param range up to which points may touch [m]
  /// @param margin beyond that, up to which it looks: it looks again after points have moved by
  ///        half of what it has found free [m]
  ContactCover(const Points& points, const IndexMap& index_map, double range, double margin);

  /// False if a point is within the range of a point or image that its rank does not have. True
  /// for a displacement that is not finite.
  /// @param displacement of all points and handles [m]
  [[nodiscard]] bool holds(std::span<const double> displacement);

  /// True if a point comes within the range of one that its rank does not have, on straight ways.
  /// @param displacement finite
  [[nodiscard]] bool is_left_by(std::span<const double> displacement, std::span<const double> step);

 private:
  /// A point or image that this rank does not have.
  struct Missing {
    Coordinates place{}, step{};
  };
  struct Box {
    Coordinates least{}, most{};
    /// Distance of a place from it [m].
    [[nodiscard]] double distance(const Coordinates& place) const;
  };

  /// By how much points may still approach one another, from a bound; infinite where a displacement
  /// is not finite [m].
  [[nodiscard]] double room(std::span<const double> displacement);
  /// Most by which a step lets two points of this rank's points and images approach [m].
  [[nodiscard]] double approach(std::span<const double> step) const;
  /// Points and images of all ranks within a distance of the box around this rank's points.
  /// @param step empty: none
  [[nodiscard]] std::vector<Missing> missing_near(std::span<const double> displacement,
                                                  std::span<const double> step,
                                                  double distance) const;
  [[nodiscard]] bool is_here(const double* record) const;

  [[nodiscard]] Index owned() const { return index_map_.own_rows(points_.own()); }
  /// Boxes around the points of each rank.
  [[nodiscard]] std::vector<Box> boxes(std::span<const double> displacement) const;
  /// Present places of this rank's points, points x 3 [m].
  [[nodiscard]] std::vector<double> places(std::span<const double> displacement) const;
  /// Displacement of a point or handle; zero without displacements.
  [[nodiscard]] Coordinates moved(Index row, std::span<const double> displacement) const;
  /// Jump of the displacement over the periods between a source and its image [m].
  [[nodiscard]] Coordinates jump(const ImageKind& kind, std::span<const double> displacement) const;

  const Points& points_;
  const IndexMap& index_map_;
  double range_, margin_;
  bool has_all_;                              // nothing can be missing
  std::array<Index, 3> handle_{-1, -1, -1};   // of the period across each axis, see Constraints
  std::vector<std::vector<char>> has_image_;  // per kind and point
  std::optional<std::vector<double>> found_at_{};
  double room_ = 0.0;  // there
};

}  // namespace peristat
