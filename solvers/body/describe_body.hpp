#pragma once

#include <string>
#include <vector>

#include "solvers/body/body.hpp"

namespace peristat {

/// Lines that describe the triangles and tetrahedra, their storage, and neighbours that are such
/// only by round-off; empty for bonds whose horizon lies between distances of their points.
[[nodiscard]] std::vector<std::string> describe_interactions(const Body& body);

/// Lines that describe foundations, obstacles, rigid sets, rollers, linear constraints, planes of
/// symmetry and periods.
[[nodiscard]] std::vector<std::string> describe_constraints(const Body& body);

}  // namespace peristat
