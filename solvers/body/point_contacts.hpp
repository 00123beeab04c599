#pragma once

#include "assembly/terms/model.hpp"
#include "solvers/body/body.hpp"

namespace peristat {

/// Adds the contacts of a body's points by its specification, on the bonds of its model.
void add_contacts(const Body& body, Model& model);

}  // namespace peristat
