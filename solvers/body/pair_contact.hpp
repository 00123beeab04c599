#pragma once

#include <memory>

#include "assembly/terms/term.hpp"
#include "solvers/body/body.hpp"

namespace peristat {

/// Makes the contacts of a body's points by its specification, on the bonds of its model.
/// @return null if it has none
[[nodiscard]] std::shared_ptr<Term> make_pair_contact(const Body& body);

/// Refuses contacts of bodies that can't have them yet: with planes of symmetry, periods, rigid
/// sets, rollers and linear constraints.
/// @throws InputError ("contacts")
void refuse_contacts_with_constraints(const BodySpecification& of);

}  // namespace peristat
