#include "assembly/terms/bonds/bond_passes.hpp"

namespace peristat {

std::unique_ptr<TermPasses> make_bond_passes(const BondFailure& failure,
                                             const TermSetting& setting) {
  switch (setting.points.dimension) {
    case 1:
      return make_bond_passes_in<1>(failure, setting);
    case 2:
      return make_bond_passes_in<2>(failure, setting);
    default:
      return make_bond_passes_in<3>(failure, setting);
  }
}

}  // namespace peristat
