#pragma once

#include "solvers/formulations/specification/body_specification.hpp"

namespace peristat {

/// Refuses contacts with numbers out of range, sets that are not there, and two contacts of one
/// pair of points.
/// @throws InputError ("contacts[k].…", k from 0)
void check_contacts(const BodySpecification& of, const Points& points);

}  // namespace peristat
