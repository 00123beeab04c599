#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

class Observation;

/// Values of a point: one, one per axis, one per principal axis, one per pair of axes, or one per
/// symmetric pair (xx, or xx, yy, xy, or xx, yy, zz, xy, yz, xz).
enum class FieldRank { scalar, vector, principal, tensor, symmetric };

/// What a field needs besides a state.
enum class FieldNeeds { nothing, stress, motion, contacts, fatigue };

/// Who shows a field: steps of results.h5, probes, or both.
enum class ShownBy { steps, probes, both };

/// Values of fields at points, by the fields' names: points x values of a point, row major.
using PointValues = std::map<std::string, std::vector<double>>;

/// A field with values at points.
struct PointField {
  std::string name, unit, meaning;
  FieldRank rank;
  /// Computes its values in a state; called once per observation, see Observation::values.
  std::vector<double> (*compute)(Observation& in);
  FieldNeeds needs = FieldNeeds::nothing;
  ShownBy shown_by = ShownBy::both;

  /// Names of its components, in the order in which results hold them; empty for a scalar.
  [[nodiscard]] std::vector<std::string> components(int dimension) const;
  /// Extents of a point's values; none for a scalar.
  [[nodiscard]] std::vector<std::uint64_t> extents(int dimension) const;
  /// Values of a point, from those of all points.
  [[nodiscard]] std::vector<double> at(const std::vector<double>& values, int dimension,
                                       Index point) const;
};

/// Every field, in the order in which steps write them. A new field is a row here: results, their
/// views and probes read this table.
[[nodiscard]] const std::vector<PointField>& point_fields();

/// Field of a name; null if there is none.
[[nodiscard]] const PointField* point_field(const std::string& name);

/// Names of the axes' components, and of their pairs, in any dimension.
[[nodiscard]] std::vector<std::string> component_names();

}  // namespace peristat
