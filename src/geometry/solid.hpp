#pragma once

#include <array>
#include <string>
#include <vector>

#include "src/geometry/shape.hpp"
#include "src/geometry/shape_boundary.hpp"

namespace peristat {

/// One step of building the body: the shape is added to it or subtracted from it, in order; the
/// boundary belongs to the shape, so that points on a subtracted shape's boundary are removed. The
/// first step adds.
struct ShapeStep {
  enum class Action { add, subtract } action = Action::add;
  Shape shape{};
  std::string name{};       ///< by which loads find its boundary; may be empty
  bool cuts_bonds = false;  ///< of a subtracted shape: bonds must not cross it
};

/// A part of space, with the queries needed to measure its share of a cell.
class Region {
 public:
  Region() = default;
  Region(const Region&) = default;
  Region& operator=(const Region&) = default;
  virtual ~Region() = default;

  [[nodiscard]] virtual bool contains(const Coordinates& place) const = 0;
  /// Appends the t at which the line may pass into the region or out of it.
  virtual void append_crossings(const Line& line, std::vector<double>& t) const = 0;
  /// Appends the heights along a direction at which sections across it change abruptly, as far as
  /// they are known.
  virtual void append_levels(const Coordinates& direction, std::vector<double>& levels) const = 0;
  /// Appends, per axis, the coordinates of planes across it that contain the whole boundary.
  /// @return false if the boundary has other parts
  virtual bool append_planes(std::array<std::vector<double>, 3>& at) const = 0;
  /// True if the boundary may pass within a distance of the place.
  [[nodiscard]] virtual bool may_end_near(const Coordinates& place, double distance) const = 0;
};

/// The body made by adding and subtracting shapes in steps.
class Solid : public Region {
 public:
  /// @param steps must outlive the solid
  Solid(int dimension, const std::vector<ShapeStep>& steps);

  [[nodiscard]] bool contains(const Coordinates& place) const override;
  void append_crossings(const Line& line, std::vector<double>& t) const override;
  void append_levels(const Coordinates& direction, std::vector<double>& levels) const override;
  bool append_planes(std::array<std::vector<double>, 3>& at) const override;
  [[nodiscard]] bool may_end_near(const Coordinates& place, double distance) const override;

  /// The same solid within a distance of a place, with only the steps that matter there.
  [[nodiscard]] Solid near(const Coordinates& place, double distance) const;

  /// True if it is one convex shape that contains all of the places, and so their hull.
  [[nodiscard]] bool holds_hull_of(const std::vector<Coordinates>& places) const;

  [[nodiscard]] int dimension() const { return dimension_; }

  /// Box around all added shapes.
  [[nodiscard]] Box bounds() const;

 private:
  int dimension_;
  std::vector<const ShapeStep*> steps_;
};

}  // namespace peristat
