#pragma once

#include <array>
#include <optional>
#include <string>

namespace peristat {

/// Prescribed displacements of a set: per component an expression of x, y, z and load [m], or
/// nothing for a free component.
struct SupportSpecification {
  std::string set{};
  std::array<std::optional<std::string>, 3> displacement{};
};

/// Dead load on a set: a body force density [N/m3], an expression of x, y, z and load, or a total
/// force [N], an expression of load alone, spread in proportion to the volume.
struct LoadSpecification {
  enum class Kind { body_force, total_force } kind = Kind::body_force;
  std::string set{};
  std::array<std::string, 3> value{"0", "0", "0"};
};

/// A term of a control: its set's mean displacement, weighted per component.
struct ControlTerm {
  std::string set{};
  std::array<double, 3> weights{};
};

}  // namespace peristat
