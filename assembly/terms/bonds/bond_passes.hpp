#pragma once

#include <memory>

#include "assembly/terms/failure/bond_failure.hpp"
#include "assembly/terms/term.hpp"

namespace peristat {

/// @return the passes over the bonds of a term that fails so, with their potential
std::unique_ptr<TermPasses> make_bond_passes(const BondFailure& failure,
                                             const TermSetting& setting);

/// The same for one dimension. Each dimension is compiled in a file of its own, since every pass is
/// instantiated for every potential.
template <int dimension>
std::unique_ptr<TermPasses> make_bond_passes_in(const BondFailure& failure,
                                                const TermSetting& setting);

}  // namespace peristat
