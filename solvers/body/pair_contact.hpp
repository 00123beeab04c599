#pragma once

#include <memory>

#include "assembly/terms/term.hpp"
#include "solvers/body/body.hpp"

namespace peristat {

/// Makes the contacts of a body's points by its specification, on the bonds of its model.
/// @return null if it has none
[[nodiscard]] std::shared_ptr<Term> make_pair_contact(const Body& body);
}  // namespace peristat
