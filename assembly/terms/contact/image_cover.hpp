#pragma once

#include <array>
#include <span>
#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

/// Tells whether all images that may touch the points of a body are there: points have images
/// beyond planes of symmetry and periods only within some distance in the reference.
class ImageCover {
 public:
  /// @param points outlive it
  /// @param range up to which points may touch [m]
  ImageCover(const Points& points, double range);

  /// False if a point may be nearer than the range to the missing image of a point.
  /// @param displacement of all points and handles, finite [m]
  [[nodiscard]] bool holds(std::span<const double> displacement) const;

 private:
  /// Images of a kind that are not there.
  struct Missing {
    std::size_t kind = 0;
    std::vector<Index> sources{};
    double away = 0.0;  ///< least distance from the box around the points [m]
  };
  struct Box {
    Coordinates least{}, most{};
    /// Distance of a place from it [m].
    [[nodiscard]] double distance(const Coordinates& place) const;
  };
  /// Box around the points that are no images.
  [[nodiscard]] Box box(std::span<const double> displacement) const;
  /// Displacement of a point or handle.
  [[nodiscard]] Coordinates moved(Index row, std::span<const double> displacement) const;
  /// Jump of the displacement over the periods between a source and its image [m].
  [[nodiscard]] Coordinates jump(const ImageKind& kind, std::span<const double> displacement) const;

  const Points& points_;
  double range_;
  std::array<Index, 3> handle_{-1, -1, -1};  // of the period across each axis, see Constraints
  std::vector<Missing> missing_;
};

}  // namespace peristat
