#include "src/neighbourhood/share_on_horizon.hpp"

namespace peristat {

double share_on_horizon(const Bonds& bonds, const Kernel& kernel,
                        const std::function<double(Index i, Index j)>& norm) {
  constexpr double shell = 1e-3;
  const bool ends_with_a_jump = kernel.volume_correction == VolumeCorrection::none &&
                                kernel.influence_at(kernel.horizon) > 0.0;
  if (!ends_with_a_jump || bonds.count() == 0) return 0.0;
  Offset there = 0;
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const double at = norm ? norm(i, bonds.partner(i, bond)) : bonds.length(bond);
      there += at >= (1.0 - shell) * kernel.horizon;
    }
  }
  return double(there) / double(bonds.count());
}

}  // namespace peristat
