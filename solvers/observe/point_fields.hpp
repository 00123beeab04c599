#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solvers/problem/records.hpp"

namespace peristat {

/// Values of a point: one, one per axis, one per principal axis, one per pair of axes, or one per
/// symmetric pair (xx, or xx, yy, xy, or xx, yy, zz, xy, yz, xz).
enum class FieldRank { scalar, vector, principal, tensor, symmetric };

/// What a field needs besides a state.
enum class FieldNeeds { nothing, stress, motion };

/// Who shows a field: steps of results.h5, probes, or both.
enum class ShownBy { steps, probes, both };

/// A field with values at points.
struct PointField {
  std::string name, unit, meaning;
  FieldRank rank;
  /// Its values in a step; of `divergence`, which no step holds, those that it is computed from.
  const std::vector<double>* StepFields::*values;
  FieldNeeds needs = FieldNeeds::nothing;
  ShownBy shown_by = ShownBy::both;

  /// Names of its components, in the order in which results hold them; empty for a scalar.
  [[nodiscard]] std::vector<std::string> components(int dimension) const;
  /// Extents of a point's values; none for a scalar.
  [[nodiscard]] std::vector<std::uint64_t> extents(int dimension) const;
  /// Values of a point.
  [[nodiscard]] std::vector<double> at(const StepFields& fields, int dimension, Index point) const;
};

/// Every field, in the order in which steps write them. A new field is a row here, a member of
/// StepFields and what computes it.
[[nodiscard]] const std::vector<PointField>& point_fields();

/// Field of a name; null if there is none.
[[nodiscard]] const PointField* point_field(const std::string& name);

/// Names of the axes' components, and of their pairs, in any dimension.
[[nodiscard]] std::vector<std::string> component_names();

}  // namespace peristat
