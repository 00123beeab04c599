#pragma once

#include <memory>

#include "assembly/terms/bonds/bond_term.hpp"

namespace peristat {

/// @return the passes over the bonds of a term, with their potential
std::unique_ptr<TermPasses> make_bond_passes(const BondTerm& term, const TermSetting& setting);

/// The same for bodies of one dimension. A file for each compiles it: it is long, since each pass
/// stands there once for each potential.
template <int dimension>
std::unique_ptr<TermPasses> make_bond_passes_in(const BondTerm& term, const TermSetting& setting);

}  // namespace peristat
