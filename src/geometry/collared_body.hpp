#pragma once

#include <functional>
#include <list>
#include <vector>

#include "src/geometry/layer.hpp"
#include "src/geometry/solid.hpp"

namespace peristat {

/// A flat outermost side of a body, or a part of it, in front of which points stand that carry a
/// support: it is no boundary, and the sides beside it continue straight as far as these points do.
struct Cover {
  Side side{};
  double face = 0.0;   ///< height of the side along its axis [m]
  double depth = 0.0;  ///< of the points in front of it [m]
  /// True for places in front of it that are covered; empty: all are.
  std::function<bool(const Coordinates&)> where{};
};

/// A body together with the regions in front of its covers: a place in front of a cover belongs to
/// it if the place's foot on the face is in the body.
class CollaredBody {
 public:
  /// @param body must outlive this
  /// @param spacing of the body's points [m]; far smaller details are ignored
  CollaredBody(const Solid& body, std::vector<Cover> covers, double spacing);
  CollaredBody(const CollaredBody&) = delete;
  CollaredBody& operator=(const CollaredBody&) = delete;

  [[nodiscard]] bool contains(const Coordinates& place) const;

  /// Appends the t at which a line may enter or leave it, without those of `where`.
  void append_crossings(const Line& line, std::vector<double>& t) const;

  [[nodiscard]] const std::vector<Cover>& covers() const { return covers_; }
  [[nodiscard]] double spacing() const { return spacing_; }

 private:
  const Solid& body_;
  std::vector<Cover> covers_;
  double spacing_;
  std::list<FrontOfFace> fronts_;
};

}  // namespace peristat
