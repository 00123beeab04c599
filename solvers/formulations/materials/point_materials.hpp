#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solvers/formulations/specification/body_specification.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// The materials of a body, and the material of each point.
class PointMaterials {
 public:
  /// A material with its key for errors and its name for messages.
  struct Material {
    const MaterialSpecification* of;
    std::string key, name;
  };

  /// @param from must outlive it
  /// @throws InputError ("regions…") for regions that overlap, and for points of no material
  PointMaterials(const BodySpecification& from, const Points& points);

  /// The body's own material, if it has constants, and those of its regions in their order.
  [[nodiscard]] const std::vector<Material>& all() const { return all_; }
  [[nodiscard]] std::size_t of(Index point) const {
    return of_point_.empty() ? 0 : of_point_[std::size_t(point)];
  }
  /// Material per point; empty: the first one for all.
  [[nodiscard]] const std::vector<std::uint8_t>& of_points() const { return of_point_; }
  /// Number of each point's region, from 0; -1: in no region.
  [[nodiscard]] std::vector<std::int32_t> regions() const;

  /// Interface between two of the materials.
  [[nodiscard]] const InterfaceSpecification& between(std::size_t a, std::size_t b) const;
  /// Its key for errors.
  [[nodiscard]] std::string key_between(std::size_t a, std::size_t b) const;

  /// Factors of the points by the materials' random fields or expressions; empty: all 1.
  /// @throws InputError ("material.scatter[0].factor") for a bad expression, and for values that
  /// are
  ///         no factors
  [[nodiscard]] std::vector<double> factors(const Points& points,
                                            ScatterSpecification::Quantity quantity,
                                            int threads) const;

 private:
  [[nodiscard]] std::ptrdiff_t interface_of(std::size_t a, std::size_t b) const;

  const BodySpecification* from_;
  bool has_rest_;
  std::vector<Material> all_;
  std::vector<std::uint8_t> of_point_;
};

}  // namespace peristat
