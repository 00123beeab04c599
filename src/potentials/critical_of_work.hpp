#pragma once

#include "src/potentials/any_law.hpp"

namespace peristat {

/// Critical stretch with which a law of another onset takes a given work, to round-off.
/// @param work int_0^s_c f ds for the modulus 1, at least onset^2 / 2
/// @param guess of the result
[[nodiscard]] double critical_of_work(const AnyBondLaw& law, double onset, double work,
                                      double guess);

}  // namespace peristat
