#include "src/neighbourhood/share_on_horizon.hpp"

namespace peristat {

double share_on_horizon(const Bonds& bonds, const Kernel& kernel) {
  constexpr double shell = 1e-3;
  const bool ends_with_a_jump = kernel.volume_correction == VolumeCorrection::none &&
                                kernel.influence_at(kernel.horizon) > 0.0;
  if (!ends_with_a_jump || bonds.count() == 0) return 0.0;
  Offset there = 0;
  for (Offset bond = 0; bond < bonds.count(); ++bond) {
    there += bonds.length(bond) >= (1.0 - shell) * kernel.horizon;
  }
  return double(there) / double(bonds.count());
}

}  // namespace peristat
