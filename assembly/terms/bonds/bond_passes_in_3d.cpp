#include "assembly/terms/bonds/bond_passes_in.hpp"

namespace peristat {

template std::unique_ptr<TermPasses> make_bond_passes_in<3>(const BondFailure&, const TermSetting&);

}  // namespace peristat
