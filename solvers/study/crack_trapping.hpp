#pragma once

#include <optional>
#include <string>
#include <utility>

#include "solvers/formulations/specification/body_specification.hpp"

namespace peristat {

/// Trapping of a running crack by a lattice of brittle bonds. Because bonds break at once, the
/// crack runs only if the stress intensity is well above that of their fracture energy, at any
/// spacing.
struct CrackTrapping {
  double horizon_ratio = 0.0;
  int dimension = 0;
  /// Range, over the angles to the lattice, of the largest stress intensity that a steady crack
  /// needs, over sqrt(E G_c) (`peristat trust trapping`); none: not measured.
  std::optional<std::pair<double, double>> needed;
};

/// Trapping in a body with brittle bonds on a lattice; nothing for other bodies.
/// @param spacing [m]
[[nodiscard]] std::optional<CrackTrapping> crack_trapping(const BodySpecification& of,
                                                          int dimension, double spacing);

/// "brittle bonds at horizon ratio 3 hold a crack up: it runs at 1.14 to 1.19 of K_Ic, …"
[[nodiscard]] std::string description(const CrackTrapping& trapping);

}  // namespace peristat
