#pragma once

#include <string>
#include <vector>

namespace peristat {

/// A field whose values probes look at.
struct ProbeField {
  std::string name, unit;
  enum class Kind { scalar, vector, principal, tensor, symmetric } kind = Kind::scalar;
  bool is_of_stress = false;  ///< found with strain and stress alone
  bool is_of_motion = false;  ///< in mode dynamics alone

  /// Names of its components, in the order in which results hold them; empty for a scalar.
  [[nodiscard]] std::vector<std::string> components(int dimension) const;
};

/// Of a field, or null for what is no field but looks at a whole set (poisson_ratio, opening,
/// crack_length, …).
[[nodiscard]] const ProbeField* probe_field(const std::string& name);

/// What `[[probe]] field` may be.
[[nodiscard]] std::vector<std::string> probe_field_names();
/// What `[[probe]] component` may be, of any field and dimension.
[[nodiscard]] std::vector<std::string> probe_component_names();

}  // namespace peristat
