#pragma once

#include <optional>
#include <vector>

#include "src/geometry/shape.hpp"

namespace peristat {

/// A region of finer points. Around the shape the spacing grows with the distance from it.
struct Refinement {
  Shape shape{};
  double spacing = 0.0;  ///< in the shape [m]
  double growth = 0.1;   ///< of the spacing per distance from the shape
};

/// Spacing of a body's points at every place: h(x) = min(h_0, h_k + g_k d_k(x)) over regions k at
/// the distances d_k (see distance_to_boundary; up to a factor of sqrt(d) shorter beside corners of
/// boxes). It changes by g d at most over a distance d, so that neighbours are about equally apart.
class SpacingField {
 public:
  /// @param spacing h_0 [m]
  /// @param regions must outlive the field
  SpacingField(int dimension, double spacing, const std::vector<Refinement>& regions);

  /// h at a place [m].
  [[nodiscard]] double at(const Coordinates& place) const;
  /// Gradient of h, by central differences over a tenth of h.
  [[nodiscard]] Coordinates gradient(const Coordinates& place) const;
  /// Number of the region that sets the spacing at a place; nothing where h is h_0.
  [[nodiscard]] std::optional<std::size_t> region_at(const Coordinates& place) const;
  [[nodiscard]] bool is_even() const { return regions_.empty(); }
  /// Smallest spacing [m].
  [[nodiscard]] double finest() const;
  /// Upper bound of the points that regions add in a box: the integral of h^-d over the boxes
  /// around the shapes, and over shells around these.
  [[nodiscard]] double most_points(const Box& body) const;

 private:
  int dimension_;
  double spacing_;
  const std::vector<Refinement>& regions_;
};

}  // namespace peristat
