#pragma once

#include <string>
#include <vector>

namespace peristat {

/// A field that probes evaluate.
struct ProbeField {
  std::string name, unit;
  enum class Kind { scalar, vector, principal, tensor, symmetric } kind = Kind::scalar;
  bool is_of_stress = false;  ///< computed with strain and stress only
  bool is_of_motion = false;  ///< in mode dynamics only

  /// Names of its components, in the order in which results hold them; empty for a scalar.
  [[nodiscard]] std::vector<std::string> components(int dimension) const;
};

/// Returns the field of a name; null for quantities of a whole set (poisson_ratio, opening,
/// crack_length, …).
[[nodiscard]] const ProbeField* probe_field(const std::string& name);

/// Allowed values of `[[probe]] field`.
[[nodiscard]] std::vector<std::string> probe_field_names();
/// Allowed values of `[[probe]] component`, for any field and dimension.
[[nodiscard]] std::vector<std::string> probe_component_names();

}  // namespace peristat
